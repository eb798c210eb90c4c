"""Skin that has grown together: found on fused figures, never on whole ones; the form of what is parted."""

import numpy as np
import pytest

from addon.core import KeptStages, Settings, canonical_form, find_contacts, mannequin
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area, vertex_areas
from tests.meshes import shapes
from tests.meshes.fused import fused_figure


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


def apart(form, truth, areas):
    """Distance after a rigid fit, root mean square by area."""
    rotation, shift = rigid_fit(form, truth, areas)
    return float(np.sqrt(areas @ ((form @ rotation + shift - truth) ** 2).sum(axis=1) / areas.sum()))


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
    form = canonical_form(vertices, faces, Settings(contacts="open"), keep=kept)
    assert any(each.kind == "contacts_unknown" for each in form.warnings)
    assert np.array_equal(form.vertices, canonical_form(vertices, faces).vertices)


def test_where_it_stands_decides_nothing(fused, contacts, kept):
    vertices, faces, _ = fused
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    found = find_contacts(3.0 * vertices @ turn.T + [5.0, 0, 1], faces, keep=kept)
    both = (found.gone & contacts.gone).sum() / (found.gone | contacts.gone).sum()
    assert both > 0.95


def test_chosen_points_are_those_of_the_mesh_as_given(fused, kept):
    vertices, faces, _ = fused
    chosen = [int(vertices[:, 2].argmax()), int(vertices[:, 2].argmin()), int(np.abs(vertices[:, 0]).argmax())]
    form = canonical_form(vertices, faces, Settings(contacts="open", feature_points=chosen), keep=kept)
    assert form.feature_points.tolist() == chosen
