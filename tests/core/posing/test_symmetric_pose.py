import numpy as np
import pytest
from scipy.spatial import cKDTree

from addon.core import Settings, mannequin, poses
from addon.core.deformation.elastic_body import ElasticBody
from addon.core.mesh.geometry import surface_area
from addon.core.posing.symmetric_pose import mirror_planes, symmetric_pose
from addon.core.run.monitor import Monitor
from addon.core.surface.laplacian import stiffness_and_mass
from addon.core.surface.triangulation import triangulated
from addon.core.symmetry.mirror import MirrorMap, Plane, asymmetry
from tests.meshes import shapes

ACROSS = Plane(np.array([1.0, 0, 0]), np.zeros(3))


def test_a_mannequin_is_its_own_mirror_image_wherever_it_stands(rotation):
    vertices, faces = mannequin(45.0)
    (plane,) = mirror_planes(7 * vertices @ rotation + 3, faces, Monitor())
    assert np.abs(plane.normal @ (np.array([1.0, 0, 0]) @ rotation)) == pytest.approx(1, abs=1e-9)


def test_a_pose_that_is_nearly_symmetric_is_not():
    vertices, faces = mannequin()
    lowered, _ = mannequin(3.0)
    one_arm = np.where(vertices[:, :1] > 0, lowered, vertices)
    assert mirror_planes(one_arm, faces, Monitor()) == []


def test_a_ball_has_three_and_a_bent_limb_two():
    assert len(mirror_planes(*shapes.sphere(3), Monitor())) == 3
    planes = mirror_planes(*shapes.joint(80), Monitor())
    assert len(planes) == 2  # the plane of its bend, and the one between its halves
    assert min(abs(plane.normal[2]) for plane in planes) < 0.001 < 0.999 < max(abs(plane.normal[2]) for plane in planes)


@pytest.fixture(scope="module")
def body():
    """A limb across the mirror, and the mirror partner of each vertex."""
    vertices, faces = shapes.joint(0)
    vertices = vertices - vertices.mean(axis=0)
    points = vertices / np.sqrt(surface_area(vertices, faces))
    partner = cKDTree(points).query(points * [-1, 1, 1])[1]
    return ElasticBody(*stiffness_and_mass(triangulated(points, faces)), points, faces), MirrorMap(partner, 1.0)


def bent(points, left, right):
    """A limb whose halves are bent upwards by two angles."""
    x, y, z = points.T
    angle = np.where(x < 0, -np.radians(left), np.radians(right)) * np.clip(np.abs(x) / 0.1, 0, 1)
    cos, sin = np.cos(angle), np.sin(angle)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, z])


@pytest.mark.parametrize(("sure", "angle"), [(1.0, 15.0), (0.25, 12.0)])
def test_both_sides_turn_by_the_mean_of_their_confidence(body, sure, angle):
    elastic, mirror = body
    posed = bent(elastic.points, 20, 10)
    confidence = np.where(elastic.points[:, 0] < 0, sure, 1.0)
    found = symmetric_pose(elastic, posed, confidence, mirror, [ACROSS])
    for side in (1, -1):
        across = side * elastic.points[:, 0]
        way = found[across > 0.3].mean(axis=0) - found[np.abs(across - 0.2) < 0.02].mean(axis=0)
        assert np.degrees(np.arctan2(way[1], side * way[0])) == pytest.approx(angle, abs=1.0)


def test_what_is_turned_far_keeps_its_shape(body):
    """The right half is twisted by a right angle: positions in the mean would be squashed flat."""
    elastic, mirror = body
    angle = np.radians(90) * np.clip(elastic.points[:, 0] / 0.1, 0, 1)
    x, y, z = elastic.points.T
    posed = np.column_stack([x, np.cos(angle) * y - np.sin(angle) * z, np.sin(angle) * y + np.cos(angle) * z])
    found = symmetric_pose(elastic, posed, np.ones(len(posed)), mirror, [ACROSS])
    end = elastic.points[:, 0] > 0.2
    assert np.ptp(found[end], axis=0)[1:] == pytest.approx(np.ptp(elastic.points[end], axis=0)[1:], rel=0.06)


def test_planes_that_do_not_take_left_to_right_are_not_used(body):
    elastic, mirror = body
    posed = bent(elastic.points, 20, 10)
    along = Plane(np.array([0.6, 0.8, 0]), np.zeros(3))
    sure = np.ones(len(posed))
    assert symmetric_pose(elastic, posed, sure, mirror, [along]) is posed
    assert symmetric_pose(elastic, posed, sure, mirror, []) is posed
    both = symmetric_pose(elastic, posed, sure, mirror, [along, ACROSS])
    np.testing.assert_array_equal(both, symmetric_pose(elastic, posed, sure, mirror, [ACROSS]))


def test_a_body_takes_a_symmetric_pose_on_both_sides_alike(monkeypatch):
    vertices, faces = mannequin()
    lowered, _ = mannequin(50.0)
    one_arm = np.where(vertices[:, :1] > 0, lowered, vertices)
    used = []

    def spied(elastic, posed, confidence, mirror, planes):
        found = symmetric_pose(elastic, posed, confidence, mirror, planes)
        used.append([asymmetry(each, mirror.partner, elastic.mass) for each in (posed, found)])
        return found

    monkeypatch.setattr(poses, "symmetric_pose", spied)
    draft = Settings(quality="draft")
    poses.pose_like(one_arm, faces, vertices, faces, draft)
    ((before, after),) = used
    assert after < before
    poses.pose_like(vertices, faces, vertices, faces, draft, reference_pose=one_arm)
    assert len(used) == 1
