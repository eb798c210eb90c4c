"""Handles are counted on closed and open surfaces, and told with a form."""

import numpy as np
import pytest

from addon.core import canonical_form
from addon.core.mesh.handles import handle_count
from tests.meshes import shapes
from tests.meshes.families import families
from tests.meshes.rings import ring


def test_a_ball_has_none_and_a_ring_has_one():
    faces = shapes.sphere(3)[1]
    assert handle_count(faces) == 0
    assert handle_count(ring()[1]) == 1


@pytest.mark.parametrize("faces", [shapes.sphere(3)[1], ring()[1]])
def test_holes_are_no_handles(faces):
    middle = [faces[0, 0], faces[len(faces) // 2, 0]]
    open_ = faces[~np.isin(faces, middle).any(axis=1)]
    assert handle_count(open_) == handle_count(faces)


def test_of_what_is_no_surface_with_two_sides_nothing_is_said():
    assert handle_count(np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]])) == 0
    assert handle_count(families()["one-sided, closed"].faces) == 0
    assert handle_count(families()["genus 5"].faces) == 5


def test_a_form_tells_them():
    points, faces, _ = ring()
    assert any(each.kind == "handles" for each in canonical_form(points, faces).warnings)
    assert not any(each.kind == "handles" for each in canonical_form(*shapes.sphere(3)).warnings)
    assert not any(each.kind == "handles" for each in canonical_form(points, faces, rest=points).warnings)
