"""Contacts marked by hand: what is between marked vertices is parted, what is protected stays."""

import numpy as np
import pytest

from addon.core import (
    CanonicalFormError,
    InvalidSettingsError,
    KeptStages,
    Settings,
    canonical_form,
    find_contacts,
    mannequin,
    rig,
)
from addon.core.fused.parting import capped, laid_open, piece_count
from addon.core.fused.star_rest import star_rest
from addon.core.mesh.edges import is_closed, vertex_pairs
from addon.core.mesh.geometry import surface_area, vertex_areas
from addon.core.rigging.reference_rig import mannequin_rig
from tests.meshes.fused import apart, fused_figure, parted
from tests.meshes.rings import ring


@pytest.fixture(scope="module")
def fused():
    """Arms at the sides, and the legs, have grown together."""
    return fused_figure(86.0, 0.015)


@pytest.fixture(scope="module")
def marked(fused):
    """The vertices of the triangles whose corners lie far apart on the figure with its arms and legs spread."""
    _, faces, origin = fused
    places = star_rest(mannequin_rig(*mannequin()))[origin]
    jump = np.linalg.norm(places[faces] - places[np.roll(faces, 1, axis=1)], axis=2).max(axis=1)
    return np.unique(faces[jump > 0.06])


def euler(faces):
    return len(np.unique(faces)) - len(vertex_pairs(faces)) + len(faces)


def kinds(result):
    return {each.kind for each in result.warnings}


def test_a_ring_cut_along_a_loop_of_edges_is_a_closed_tube():
    points, faces, along = ring()
    loop = np.flatnonzero(along == 0)
    pairs = vertex_pairs(faces)
    cut = pairs[np.isin(pairs, loop).all(axis=1)]
    mesh = parted(points, faces, np.zeros(len(faces), dtype=bool), points, cut=cut)
    assert mesh.caps == 2
    assert is_closed(mesh.faces)
    assert euler(mesh.faces) == 2
    assert (np.bincount(mesh.origin[mesh.origin >= 0])[loop] == 2).all()
    assert piece_count(mesh.faces) == 1


def test_an_edge_inside_of_a_surface_parts_nothing():
    points, faces, _ = ring()
    opened = laid_open(points, faces, np.zeros(len(faces), dtype=bool), vertex_pairs(faces)[:1], 1.0)
    assert opened.lips == []
    assert np.array_equal(capped(opened, points, 1.0).faces, opened.faces)


@pytest.mark.parametrize("how", ["faces", "edges"])
def test_the_form_of_a_marked_ring_is_long(how):
    points, faces, along = ring()
    marks = np.flatnonzero(along == 0 if how == "edges" else np.isin(along, along[[0, 16]]))
    whole, tube = (canonical_form(points, faces, Settings(part_here=each)) for each in (None, marks))
    assert "handles" in kinds(whole)
    assert tube.warnings == []
    assert np.ptp(tube.vertices, axis=0).max() > 2 * np.ptp(whole.vertices, axis=0).max()
    assert np.array_equal(np.flatnonzero(tube.contacts), marks)
    assert tube.parted is not None
    mesh, form, _ = tube.parted
    assert euler(mesh.faces) == 2
    assert len(form.vertices) == len(mesh.vertices) > len(points)


def test_a_web_that_is_marked_is_parted_and_capped_as_the_body_has_it(fused, marked):
    """A cap that is short in the pose would join arm and side again."""
    vertices, faces, origin = fused
    truth = canonical_form(*mannequin()).vertices
    truth = (truth / np.sqrt(surface_area(truth, mannequin()[1])))[origin]
    areas, gaps = vertex_areas(vertices, faces), {}
    for marks in (None, marked):
        form = canonical_form(vertices, faces, Settings(part_here=marks, contacts="keep")).vertices
        gaps[marks is None] = apart(form / np.sqrt(surface_area(form, faces)), truth, areas)
    assert gaps[False] < 0.65 * gaps[True]


def test_marks_and_a_search_add_up_and_what_is_protected_stays(fused, marked):
    vertices, faces, _ = fused
    kept = KeptStages()
    found = find_contacts(vertices, faces, keep=kept)
    right = vertices[:, 0] < 0
    both, without = (
        canonical_form(vertices, faces, Settings(contacts="open", **each), keep=kept)
        for each in ({"part_here": marked}, {"keep_joined": np.flatnonzero(right)})
    )
    assert both.contacts[marked].all()
    assert both.contacts[faces[found.gone]].all()
    assert without.contacts[~right].any()
    assert not without.contacts[np.setdiff1d(np.flatnonzero(right), faces[~right[faces].all(axis=1)])].any()
    again = canonical_form(vertices, faces, Settings(part_here=marked, keep_joined=marked, contacts="keep"))
    assert again.contacts[marked].all()  # only what was found is protected


def test_copies_at_a_seam_are_marked_together():
    points, faces, along = ring()
    seam = np.flatnonzero(along == along[32])
    copy = np.arange(len(points))
    copy[seam] = len(points) + np.arange(len(seam))
    after = (along[faces].mean(axis=1) > along[32]) & (along[faces].mean(axis=1) < 3)
    split = np.where(after[:, None], copy[faces], faces)
    form = canonical_form(np.concatenate([points, points[seam]]), split, Settings(part_here=copy[seam]))
    assert form.contacts[seam].all()
    assert form.contacts[copy[seam]].all()
    assert np.array_equal(form.vertices[seam], form.vertices[copy[seam]])
    assert "handles" not in kinds(form)


def test_marks_that_mark_nothing_say_so():
    points, faces, _ = ring()
    form = canonical_form(points, faces, Settings(part_here=[5], quality="draft"))
    assert "part_here_nothing" in kinds(form)
    assert np.array_equal(form.vertices, canonical_form(points, faces, Settings(quality="draft")).vertices)
    assert form.parted is None


def test_what_comes_off_is_told():
    points, faces, along = ring()
    form = canonical_form(points, faces, Settings(part_here=np.flatnonzero(np.isin(along, along[[0, 800]]))))
    assert "part_here_loose" in kinds(form)


@pytest.mark.parametrize("marks", [[0.5], [-1], [[1, 2]], "all", [[1], [2, 3]]])
def test_marks_that_are_no_vertices_are_refused(marks):
    with pytest.raises(InvalidSettingsError):
        Settings(part_here=marks)


def test_marks_of_another_mesh_are_refused():
    with pytest.raises(InvalidSettingsError, match="keep_joined must lie between 0 and 1535"):
        canonical_form(ring()[0], ring()[1], Settings(keep_joined=[1536]))


def test_marks_of_all_of_a_piece_are_none():
    """Nothing would be left of it; the other piece is parted where it is marked."""
    points, faces, along = ring()
    two = np.concatenate([points, points + np.array([0, 0, 5])])
    marks = np.concatenate([np.flatnonzero(along == 0), len(points) + np.arange(len(points))])
    form = canonical_form(two, np.concatenate([faces, len(points) + faces]), Settings(part_here=marks))
    assert "part_here_all" in kinds(form)
    assert np.array_equal(np.flatnonzero(form.contacts), np.flatnonzero(along == 0))
    assert np.ptp(form.vertices[len(points) :], axis=0).max() > 1


def test_a_rest_pose_of_another_mesh_is_refused():
    points, faces, along = ring()
    with pytest.raises(CanonicalFormError):
        canonical_form(points, faces, Settings(part_here=np.flatnonzero(along == 0)), rest=points[:-1])


def test_no_marks_are_none():
    assert Settings(part_here=[]).part_here is None
    assert Settings(part_here=np.array([], dtype=int)).part_here is None
    assert Settings(part_here=np.arange(3)) == Settings(part_here=(0, 1, 2))


def test_marks_are_believed_under_a_rig_too(fused, marked):
    vertices, faces, _ = fused
    settings = Settings(part_here=marked, quality="draft", contacts="open")
    form = canonical_form(vertices, faces, settings, rest=vertices)
    assert form.contacts[marked].all()


def test_a_rig_is_that_of_what_is_parted(fused, marked):
    vertices, faces, _ = fused
    rigged = rig(vertices, faces, None, Settings(part_here=marked, quality="draft"))
    np.testing.assert_allclose(rigged.weights.sum(axis=1), 1, atol=1e-9)
    hands = [rigged.skeleton.heads[rigged.skeleton.names.index(f"hand.{side}")] for side in "LR"]
    for hand in hands:
        assert 0.2 < abs(hand[0]) < 0.4
        assert 0.6 < hand[2] < 1.0
