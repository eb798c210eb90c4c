"""Where pieces lie near each other."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core.assembly.bodies import bodies_of
from addon.core.assembly.contacts import neighbourhoods, sampled
from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.geometry import surface_area
from tests.meshes import shapes


def rods(gap, scale=1.0):
    """Two long rods side by side in a plane, the second half as long: their bounding boxes depend on the turn."""
    vertices, faces = shapes.cylinder(12, 40, 0.05, 4.0)
    beside = vertices * [1.0, 1, 0.6] + [gap + 0.1, 0, 0]
    return scale * np.vstack([vertices, beside]), np.vstack([faces, faces + len(vertices)])


@pytest.mark.parametrize(("gap", "groups"), [(0.06, 1), (0.35, 2), (3.0, 2)])
@pytest.mark.parametrize("scale", [1.0, 1e-160, 1e150])
def test_the_turn_of_a_mesh_does_not_decide_what_may_belong_together(gap, groups, scale):
    vertices, faces = rods(gap, scale)
    for seed in range(8):
        turn = Rotation.random(random_state=seed).as_matrix()
        pieces = connected_pieces(vertices @ turn, faces).pieces
        assert len(neighbourhoods(pieces)) == groups
        assert len(bodies_of(vertices @ turn, faces).bodies) == 2  # side by side, they do not hold each other


def test_what_is_near_for_the_larger_is_near(sphere):
    vertices, faces = sphere
    small = 0.05 * vertices + [1.15, 0, 0]
    for gap, groups in ((0.0, 1), (0.2, 1), (0.45, 2)):  # a tenth of sqrt(4 pi) is .354
        beside = small + np.array([gap, 0, 0])
        mesh = np.vstack([vertices, beside]), np.vstack([faces, faces + len(vertices)])
        assert len(neighbourhoods(connected_pieces(*mesh).pieces)) == groups


def test_groups_are_chained_and_come_by_their_largest_pieces():
    vertices, faces = shapes.sphere(2)
    sizes, places = [1.0, 0.9, 0.8, 0.7, 0.6], [0.0, 20.0, 21.75, 1.75, 3.1]
    points = [size * vertices + [place, 0, 0] for size, place in zip(sizes, places, strict=True)]
    mesh = np.vstack(points), np.vstack([faces + number * len(vertices) for number in range(5)])
    groups = neighbourhoods(connected_pieces(*mesh).pieces)
    sizes_found = [[round(float(np.ptp(piece.points[:, 1])) / 2, 1) for piece in group] for group in groups]
    assert sizes_found == [[1.0, 0.7, 0.6], [0.9, 0.8]]


def test_samples_are_spread_by_area_and_lie_on_their_triangles():
    vertices, faces = shapes.grid(4, 3, 3.0, 1.0)
    samples = sampled(vertices, faces, 0.05)
    assert len(samples.points) == round(surface_area(vertices, faces) / 0.05**2)
    assert samples.weights.min() >= 0
    np.testing.assert_allclose(samples.weights.sum(axis=1), 1)
    np.testing.assert_allclose(samples.on(vertices), samples.points)
    np.testing.assert_allclose(np.abs(samples.normals), np.broadcast_to([0, 0, 1], samples.normals.shape), atol=1e-12)
    left = (samples.points[:, 0] < samples.points[:, 0].mean()).mean()
    assert left == pytest.approx(0.5, abs=0.02)
    nearest = samples.nearest_corners
    apart = np.linalg.norm(vertices[samples.corners] - samples.points[:, None], axis=2)
    assert (np.take_along_axis(samples.corners, apart.argmin(axis=1)[:, None], 1)[:, 0] == nearest).mean() > 0.8
    assert len(sampled(vertices, faces, 10.0).points) == 24
