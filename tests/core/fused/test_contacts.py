"""Skin that has grown together: found on fused figures, never on whole ones; the form of what is parted."""

import numpy as np
import pytest

from addon.core import (
    InvalidSettingsError,
    KeptStages,
    Settings,
    canonical_form,
    find_contacts,
    mannequin,
    match,
    pose_like,
    rig,
    stance_by_match,
)
from addon.core.assembly.opening import opened
from addon.core.fused.suspicion import SUSPECT, unlike_whole_human
from addon.core.mesh.edges import edge_table
from addon.core.mesh.geometry import surface_area, vertex_areas
from addon.core.mesh.repair import repaired
from addon.core.run.monitor import Monitor
from tests.meshes import shapes, tubes
from tests.meshes.fused import apart, fused_figure
from tests.meshes.rings import ring


@pytest.fixture(scope="module")
def kept():
    return KeptStages()


@pytest.fixture(scope="module")
def fused():
    """Arms at the sides, and the legs, have grown together."""
    return fused_figure(86.0, 0.015)


@pytest.fixture(scope="module")
def contacts(fused, kept):
    return find_contacts(*fused[:2], keep=kept)


def of_unit_area(vertices, faces):
    return vertices / np.sqrt(surface_area(vertices, faces))


def test_arms_and_legs_that_have_grown_together_are_found(contacts):
    assert contacts.explained
    assert contacts.residual < 0.006
    assert contacts.gone.sum() > 100
    sides = {frozenset(name.partition(".")[0] for name in pair) for pair in contacts.between}
    assert frozenset({"thigh"}) in sides  # left and right
    assert any(name.startswith(("upper_arm", "forearm")) for pair in contacts.between for name in pair)


def test_the_form_of_what_is_parted_is_nearer_to_that_of_the_whole_figure(fused, contacts, kept):
    vertices, faces, origin = fused
    truth = of_unit_area(canonical_form(*mannequin()).vertices, mannequin()[1])[origin]
    areas, shapes_of = vertex_areas(vertices, faces), {}
    for way in ("keep", "open"):
        found = canonical_form(vertices, faces, Settings(contacts=way), keep=kept if way == "open" else None)
        shapes_of[way] = apart(of_unit_area(found.vertices, faces), truth, areas)
        assert found.vertices.shape == vertices.shape
        assert np.isfinite(found.vertices).all()
        assert found.patches.min() >= 0
        assert found.feature_points.max() < len(vertices)
        assert found.contacts.any() == (way == "open")
        assert any(each.kind == "contacts_opened" for each in found.warnings) == (way == "open")
    assert shapes_of["open"] < 0.65 * shapes_of["keep"]
    assert set(np.flatnonzero(found.contacts)) == set(contacts.faces[contacts.gone].ravel())
    mesh = contacts.parted()
    again = repaired(mesh.vertices, mesh.faces).faces
    assert len(again) == len(mesh.faces)
    assert len(edge_table(again).alone) == 0  # nothing is torn again
    assert not any(each.kind == "duplicate_faces" for each in found.warnings)


@pytest.mark.parametrize("arms", [45.0])
def test_a_whole_figure_has_none(arms, kept):
    found = find_contacts(*mannequin(arms), keep=kept)
    assert found.explained
    assert not found.gone.any()
    assert found.between == []


def test_of_what_is_no_human_nothing_is_known(kept):
    vertices, faces = shapes.sphere(3)
    found = find_contacts(vertices, faces, keep=kept)
    assert not found.explained
    assert not found.gone.any()


@pytest.mark.parametrize("mesh", ["sphere", "ring", "tube", "mannequin"])
def test_what_is_not_suspected_is_computed_as_it_is(mesh):
    """To the bit, and with the same warnings; a ring has a handle by nature, a tube is no body without arms."""
    vertices, faces = {
        "sphere": lambda: shapes.sphere(3),
        "ring": lambda: ring()[:2],
        "tube": lambda: tubes.tube(tubes.double_bend, 16, 100),
        "mannequin": lambda: mannequin(40.0),
    }[mesh]()
    kept, opened = (canonical_form(vertices, faces, Settings(contacts=way)) for way in ("keep", "open"))
    assert opened.parted is None
    np.testing.assert_array_equal(opened.vertices, kept.vertices)
    assert opened.warnings == kept.warnings
    assert list(opened.timings) == list(kept.timings)


def test_bodies_are_suspected_by_their_limbs_alone(fused):
    """A whole figure is not, in any pose and size; one whose arms have grown together with its sides is."""

    def unlike(vertices, faces):
        bodies = opened(vertices, faces, Settings(), Monitor()).bodies
        body = max(bodies, key=lambda each: len(each.faces))
        return unlike_whole_human(body.features(None, Settings(), Monitor()).spectrum.eigenvalues)

    whole = [unlike(scale * vertices, faces) for scale, (vertices, faces) in ((1, mannequin()), (9, mannequin(50.0)))]
    assert max(whole) < SUSPECT < unlike(*fused[:2])
    assert unlike_whole_human(np.array([0.0, 5.0])) == 0
    assert unlike_whole_human(np.array([0.0, 20, 40, 60, 80, 100, 120])) == 0  # too stout for a human


def test_a_cut_that_makes_no_human_of_it_is_not_believed(fused, kept, monkeypatch):
    """It is told that limbs have grown together instead."""
    from addon.core import contacts as module

    measured = iter([0.2, 0.25])
    monkeypatch.setattr(module, "unlike_whole_human", lambda _: next(measured))
    form = canonical_form(fused[0], fused[1], keep=kept)
    assert form.parted is None
    assert [each.kind for each in form.warnings if each.kind.startswith("contacts")] == ["contacts_left"]


def test_where_it_stands_decides_nothing(fused, contacts, kept):
    vertices, faces, _ = fused
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    found = find_contacts(3.0 * vertices @ turn.T + [5.0, 0, 1], faces, keep=kept)
    both = (found.gone & contacts.gone).sum() / (found.gone | contacts.gone).sum()
    assert both > 0.95


def test_copies_at_seams_and_loose_vertices_are_where_they_belong(fused, kept):
    vertices, faces, _ = fused
    left = vertices[faces].mean(axis=1)[:, 0] < 0
    seam = np.intersect1d(faces[left], faces[~left])
    copy = np.arange(len(vertices))
    copy[seam] = len(vertices) + np.arange(len(seam))
    split = np.where(left[:, None], copy[faces], faces)
    points = np.concatenate([vertices, vertices[seam], [[5.0, 6, 7]]])
    form = canonical_form(points, split, Settings(contacts="open"), keep=kept)
    assert {"contacts_opened", "coincident_borders", "loose_vertices"} <= {each.kind for each in form.warnings}
    np.testing.assert_array_equal(form.vertices[len(vertices) : -1], form.vertices[seam])
    np.testing.assert_array_equal(form.vertices[-1], [5, 6, 7])
    assert form.patches[-1] == -1
    assert form.adf[-1] == 0
    np.testing.assert_array_equal(form.patches[len(vertices) : -1], form.patches[seam])
    np.testing.assert_array_equal(form.contacts[len(vertices) : -1], form.contacts[seam])


@pytest.mark.parametrize("chosen", [[10**6], [-1], [1.5], [3, 3]])
def test_bad_points_are_refused_before_the_search(fused, chosen):
    with pytest.raises(InvalidSettingsError):
        canonical_form(fused[0], fused[1], Settings(contacts="open", feature_points=chosen))


def test_a_form_is_a_reference_for_itself(fused, kept):
    vertices, faces, _ = fused
    settings = Settings(contacts="open")
    form = canonical_form(vertices, faces, settings, keep=kept)
    again = canonical_form(vertices, faces, settings, reference=form, keep=kept)
    size = np.ptp(form.vertices, axis=0).max()
    assert np.linalg.norm(again.vertices - form.vertices, axis=1).max() < 1e-9 * size
    assert again.feature_points.tolist() == form.feature_points.tolist()
    assert not any(each.kind.startswith("reference") for each in again.warnings)


def test_what_the_caller_changes_later_is_not_kept(fused, kept):
    vertices, faces = fused[0].copy(), fused[1]
    first = canonical_form(vertices, faces, Settings(contacts="open"), keep=kept)
    form = first.vertices.copy()
    first.faces[:] = 0
    vertices *= 2
    again = canonical_form(fused[0], faces, Settings(contacts="open"), keep=kept)
    np.testing.assert_allclose(again.vertices, form, atol=1e-9)


def test_a_rig_is_believed(fused):
    form = canonical_form(fused[0], fused[1], Settings(contacts="open", quality="draft"), rest=fused[0])
    assert form.parted is None


def test_matches_and_other_poses_are_those_of_the_parted_body(fused):
    vertices, faces, origin = fused
    there, triangles = mannequin()
    apart = {}
    for way in ("keep", "open"):
        settings = Settings(contacts=way, quality="draft")
        posed = pose_like(vertices, faces, there, triangles, settings)
        found = match(vertices, faces, there, triangles, settings)
        points = np.einsum("ij,ijk->ik", found.weights, there[found.other_faces[found.faces]])
        apart[way] = float(np.linalg.norm(points - there[origin], axis=1).mean())
        np.testing.assert_array_equal(posed.match.faces, found.faces)
        assert posed.vertices.shape == vertices.shape
        assert len(found.confidence) == len(vertices)
    assert apart["open"] < 0.7 * apart["keep"]


def test_poses_and_rigs_are_those_of_the_parted_body(fused, kept):
    vertices, faces, _ = fused
    settings = Settings(contacts="open")
    posed = stance_by_match(vertices, faces, settings, keep=kept)
    assert posed.vertices.shape == vertices.shape
    assert posed.match.confidence.shape == (len(vertices),)
    assert any(each.kind == "contacts_opened" for each in posed.warnings)
    rigged = rig(vertices, faces, None, settings, keep=kept)
    np.testing.assert_allclose(rigged.weights.sum(axis=1), 1, atol=1e-9)
    names, heads = rigged.skeleton.names, rigged.skeleton.heads
    for side in "LR":  # arms down at the sides
        wrist, shoulder = (heads[names.index(f"{bone}.{side}")] for bone in ("hand", "upper_arm"))
        assert shoulder[2] - wrist[2] > 0.4


def test_chosen_points_are_those_of_the_mesh_as_given(fused, kept):
    vertices, faces, _ = fused
    chosen = [int(vertices[:, 2].argmax()), int(vertices[:, 2].argmin()), int(np.abs(vertices[:, 0]).argmax())]
    form = canonical_form(vertices, faces, Settings(contacts="open", feature_points=chosen), keep=kept)
    assert form.feature_points.tolist() == chosen
