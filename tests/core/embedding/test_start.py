"""The intrinsic start, and the qualities."""

import numpy as np
import pytest

from addon.core import Settings, canonical_form
from addon.core.distances.farthest_points import farthest_points
from addon.core.distances.heat import HeatMethod
from addon.core.embedding.start import handedness, laid_out, landmark_distances
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.connectivity import is_closed
from addon.core.mesh.geometry import signed_volume, surface_area
from addon.core.unfolding.costs import memory_estimate
from addon.core.run.monitor import Monitor
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from tests.meshes import shapes
from tests.meshes.shapes import prepared


def layout_of(vertices, faces):
    points, surface = prepared(vertices, faces)
    spectrum = compute_spectrum(stiffness(surface), mass(surface), 60)
    heat = HeatMethod(surface, 0.005, refine=False)
    landmarks, distances = farthest_points(heat, np.array([0]), heat.distances([0]), 60, monitor=Monitor())
    return laid_out(landmark_distances(distances, landmarks, spectrum), landmarks, points, faces)[0]


def test_volume_and_closedness():
    vertices, faces = shapes.sphere(4)
    assert signed_volume(vertices, faces) == pytest.approx(4 / 3 * np.pi, rel=0.01)
    assert signed_volume(vertices, faces[:, ::-1]) == pytest.approx(-4 / 3 * np.pi, rel=0.01)
    assert is_closed(faces)
    assert not is_closed(faces[1:])
    assert not is_closed(np.concatenate([faces, faces]))


def test_handedness_tells_a_ball_from_a_tie():
    vertices, faces = shapes.sphere(4)
    assert handedness(vertices, faces) == pytest.approx(4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1, 1, -1], faces) == pytest.approx(-4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1, 1, 0], faces) == 0


def test_the_layout_is_outside_out_or_flat(figure):
    for vertices, faces in (shapes.sphere(4), figure):
        layout = layout_of(vertices, faces)
        assert handedness(layout, faces) >= 0
        inward = layout_of(vertices, faces[:, ::-1])  # a mesh whose triangles face inwards
        turn, shift = rigid_fit(inward, layout)
        assert np.abs(inward @ turn + shift - layout).max() < 1e-6


def test_a_mirrored_mesh_has_the_mirrored_layout(figure):
    vertices, faces = figure
    layout = layout_of(vertices, faces)
    mirrored = layout_of(vertices * [-1, 1, 1], faces[:, ::-1])
    turn, shift = rigid_fit(mirrored, layout * [-1, 1, 1])
    assert np.abs(mirrored @ turn + shift - layout * [-1, 1, 1]).max() < 1e-6


def test_draft_normal_and_full_agree(figure):
    vertices, faces = figure
    forms = [canonical_form(vertices, faces, Settings(quality=quality)) for quality in ("draft", "normal", "full")]
    for form in forms[:2]:
        assert len(form.feature_points) == len(forms[2].feature_points)
        turn, shift = rigid_fit(form.vertices, forms[2].vertices)
        apart = np.sqrt(((form.vertices @ turn + shift - forms[2].vertices) ** 2).sum(axis=1).mean())
        assert apart < 0.06 * np.sqrt(surface_area(vertices, faces))
    assert forms[0].pair_count < forms[1].pair_count < forms[2].pair_count


def test_the_memory_is_known_beforehand():
    normal = [memory_estimate(count, Settings()) for count in (1_000, 10_000, 1_000_000)]
    assert normal == sorted(normal)
    assert normal[-1] < 6
    assert memory_estimate(10_000, Settings(quality="full")) > normal[1]
