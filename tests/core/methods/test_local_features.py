"""Equation 10 with repairs: a stress of patches, and of landmarks between them."""

import numpy as np
import pytest

from addon.core import Settings, TooLargeError, canonical_form
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.geometry import surface_area
from addon.core.methods import local_features
from tests.meshes import shapes
from tests.meshes.shapes import Mesh

OURS = Settings(method="local_features")


@pytest.fixture(scope="module")
def form(figure: Mesh):
    return canonical_form(*figure, OURS)


def test_its_figures_are_those_of_its_stress(figure, form):
    vertices, faces = figure
    assert surface_area(form.vertices, faces) == pytest.approx(surface_area(vertices, faces), rel=1e-9)
    assert len(form.stress) > 5
    assert (np.diff(form.stress) <= 1e-12 * form.stress[:-1]).all()
    assert form.pair_reduction == 1 - form.pair_count / len(vertices) ** 2
    assert 0.6 < form.pair_reduction < 0.99
    assert [told.kind for told in form.warnings] == ["one_pair"]  # among the five limbs of the figure


def test_too_few_iterations_are_reported(figure: Mesh):
    told = canonical_form(*figure, Settings(method="local_features", max_iterations=2)).warnings[-1]
    assert "before it converged" in told


def test_a_bent_sheet_is_unrolled_by_exact_geodesics(monkeypatch):
    monkeypatch.setattr(local_features, "_SMOOTHING", 0.0)
    vertices, faces = shapes.grid(33, 17, 2.0, 1.0)
    rolled = np.column_stack([np.cos(2 * vertices[:, 0]), np.sin(2 * vertices[:, 0]), 2 * vertices[:, 1]]) / 2
    settings = Settings(method="local_features", quality="full", feature_points=[280], preserve_detail=0)
    form = canonical_form(rolled, faces, settings)
    centred = form.vertices - form.vertices.mean(axis=0)
    assert np.ptp(centred @ np.linalg.svd(centred, full_matrices=False)[2][2]) < 0.05
    stretch = edge_stretch(rolled, form.vertices, faces)
    assert np.abs(stretch / np.median(stretch) - 1).mean() < 0.03


def test_a_mesh_that_stays_too_large_is_refused_before_its_pairs_are_made():
    fans = [[0, 1, 2, 3, 4 + i] for i in range(1400)]  # what hangs on edges of many triangles cannot be removed
    faces = np.array([face for a, b, c, d, e in fans for face in ((a, b, e), (b, c, e), (c, d, e), (d, a, e))])
    vertices = np.random.default_rng(0).normal(size=(1404, 3))
    with pytest.raises(TooLargeError, match="Merge vertices by distance"):
        canonical_form(vertices, faces, Settings(method="local_features", quality="draft", memory_limit=0.155))
