"""Limbs pushed straight, with the lengths of the surface."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest

from addon.core import Settings, canonical_form
from addon.core.deformation.elastic_body import ElasticBody
from addon.core.embedding import straightening as module
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.edges import pairs_across_edges
from addon.core.run.monitor import Monitor
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes, tubes
from tests.meshes.shapes import Mesh

AROUND = 24


def rings(vertices):
    """Centres and girths of the rings of a tube."""
    ring = vertices[: 60 * AROUND].reshape(60, AROUND, 3)
    girth = np.linalg.norm(ring - np.roll(ring, 1, axis=1), axis=2).sum(axis=1)
    return ring.mean(axis=1), girth


@pytest.mark.parametrize("degrees", [0, 60, 120, 175])
def test_a_bent_tube_comes_out_straight_and_as_long_and_wide_as_it_was(degrees: int):
    vertices, faces = shapes.joint(degrees, radius=0.25)
    form = canonical_form(vertices, faces).vertices
    centre, girth = rings(form)
    length = np.linalg.norm(np.diff(centre, axis=0), axis=1).sum()
    assert np.linalg.norm(centre[-1] - centre[0]) > 0.99 * length
    assert length == pytest.approx(4.0, rel=0.025)
    assert np.median(girth / rings(vertices)[1]) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("curve", [tubes.circle(90), tubes.circle(180), tubes.circle(270), tubes.double_bend])
def test_a_thin_tube_is_straight_up_to_its_ends_and_nowhere_narrow(curve: tubes.Curve):
    vertices, faces = tubes.tube(curve, AROUND, 160)
    centre, girth = tubes.rings(canonical_form(vertices, faces).vertices, AROUND)
    length = tubes.length_of(centre)
    assert np.linalg.norm(centre[-1] - centre[0]) > 0.995 * length
    assert length == pytest.approx(4.0, rel=0.01)
    np.testing.assert_allclose((girth / tubes.rings(vertices, AROUND)[1])[5:-5], 1.0, atol=0.03)


def test_the_stress_alone_leaves_it_curved_as_before():
    vertices, faces = shapes.joint(120, radius=0.25)
    centre, _ = rings(canonical_form(vertices, faces, Settings(arrangement="stress")).vertices)
    length = np.linalg.norm(np.diff(centre, axis=0), axis=1).sum()
    assert np.linalg.norm(centre[-1] - centre[0]) < 0.98 * length


def test_poses_come_nearer_to_each_other_and_edges_keep_their_lengths(real_mesh: Callable[[str], Mesh]):
    meshes = [real_mesh(f"horse/{name}.obj") for name in ("bind", "horse_gallop_f00", "horse_idle_04_f76")]
    apart, stretched = [], []
    for arrangement in ("stress", "straight"):
        forms = [canonical_form(*mesh, Settings(arrangement=arrangement)).vertices for mesh in meshes]
        fits = [(one, two, *rigid_fit(one, two)) for one, two in combinations(forms, 2)]
        apart.append(np.mean([np.sqrt(((a @ turn + shift - b) ** 2).sum(axis=1).mean()) for a, b, turn, shift in fits]))
        edges = [edge_stretch(mesh[0], form, mesh[1]) for mesh, form in zip(meshes, forms, strict=True)]
        stretched.append(np.mean([np.median(np.abs(each - 1)) for each in edges]))
    assert apart[1] < 0.75 * apart[0]
    assert stretched[1] < stretched[0]


def test_a_start_from_the_pose_and_a_bare_form_are_not_straightened():
    figure = shapes.figure(15)
    for options in ({"start": "input"}, {"preserve_detail": 0.0}):
        straight, stress = (
            canonical_form(*figure, Settings(arrangement=each, **options)).vertices for each in ("straight", "stress")
        )
        np.testing.assert_array_equal(straight, stress)


def test_edges_of_needles_are_no_stiffer_than_fifty_equilateral_ones(monkeypatch: pytest.MonkeyPatch):
    vertices, faces = shapes.sphere(2)
    vertices = vertices * np.array([1.0, 1.0, 100.0])
    body = ElasticBody(triangulated(vertices, faces), vertices, faces)
    given: list[np.ndarray] = []

    class Seen(module.Pushing):
        def __init__(self, *args, **options):
            given.append(options["stiffness"])
            super().__init__(*args, **options)

    monkeypatch.setattr(module, "Pushing", Seen)
    module.straightened(
        body, faces, vertices, np.arange(4), 1.0, np.arange(1), vertices[:, :1], max_iterations=1, monitor=Monitor()
    )
    cotangents = np.sqrt(3) * body.shell()[1]
    assert cotangents.max() > 100
    expected = [*np.where(cotangents > 50, 50, cotangents), *np.full(len(pairs_across_edges(faces)), 2.0)]
    np.testing.assert_allclose(given[0], expected, rtol=1e-12)
