"""Bones laid by assignments."""

import numpy as np
import pytest

from addon.core.fused.patch_rig import patch_rig
from addon.core.mesh.geometry import surface_area, vertex_areas, vertex_normals
from addon.core.rigging.articulated_fit import laid_on, nearest_of_posed
from addon.core.rigging.bone_fit import BoneFit
from addon.core.rigging.transport import transported_bones
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor
from tests.meshes.animals import walker


@pytest.fixture(scope="module")
def rig():
    vertices, faces = walker()
    points = vertices / np.sqrt(surface_area(vertices, faces))
    return patch_rig(points, faces, points, 8)


def still(rig):
    count = len(rig.skeleton.names)
    turns = np.broadcast_to(np.eye(3), (count, 3, 3)).copy()
    return BoneFit(rig.skeleton.heads, rig.skeleton.tails, turns, np.ones((count, 2)))


def assigned(rig, bones, points, monitor=None):
    """Bones laid onto points, the triangles of which are those of the rig or of the other body."""
    faces = rig.faces if isinstance(points, np.ndarray) else points[1]
    points = points if isinstance(points, np.ndarray) else points[0]
    normals, areas = vertex_normals(points, faces), vertex_areas(points, faces)
    return transported_bones(rig, bones, points, normals, areas, monitor or Monitor())


def closest(rig, bones, points, faces):
    normals, areas = vertex_normals(points, faces), vertex_areas(points, faces)
    return laid_on(rig, bones, points, normals, areas, Monitor())


def test_a_body_that_was_turned_is_met(rig):
    angle = np.radians(25.0)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    points = rig.vertices @ turn.T + [0.05, 0.02, 0]
    found, left = assigned(rig, still(rig), points)
    laid = found.posed(rig, rig.vertices, rig.weights)
    assert np.linalg.norm(laid - points, axis=1).mean() < 0.01
    assert left < 0.03


def test_two_legs_do_not_come_to_lie_on_one(rig):
    """A fore leg that has swung far back is nearer to the hind leg that was there: closest points mistake it."""
    vertices, faces = walker(0.8)
    points = vertices / np.sqrt(surface_area(vertices, faces))
    feet = {}
    for name, start in (("closest", still(rig)), ("assigned", assigned(rig, still(rig), (points, faces))[0])):
        bones = closest(rig, start, points, faces)
        normals = vertex_normals(points, faces)
        there = nearest_of_posed(rig, bones, points, normals, Monitor()).on(rig.vertices, rig.faces)
        fore = (points[:, 2] < points[:, 2].min() + 0.15) & (points[:, 1] < 0)
        feet[name] = int((there[fore, 0] > 0).sum()), int((there[fore, 0] < 0).sum())
    assert min(feet["assigned"]) > 0.3 * max(feet["assigned"])  # both, by half
    assert min(feet["assigned"]) >= min(feet["closest"])


def test_the_same_twice(rig):
    one, two = (assigned(rig, still(rig), rig.vertices) for _ in range(2))
    np.testing.assert_array_equal(one[0].heads, two[0].heads)
    assert one[1] == two[1]


def test_it_can_be_stopped(rig):
    with pytest.raises(CancelledError):
        assigned(rig, still(rig), rig.vertices, Monitor(cancelled=lambda: True))
