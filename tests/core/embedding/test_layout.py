"""The layout of the limbs, and whether it tells a surface from its mirror image."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from addon.core import canonical_form
from addon.core.distances.farthest_points import farthest_points
from addon.core.distances.heat import HeatMethod
from addon.core.embedding.layout import handedness, laid_out
from addon.core.measures.alignment import rigid_fit
from addon.core.run.monitor import Monitor
from addon.core.symmetry.limbs import Limbs
from tests.meshes import shapes
from tests.meshes.animals import giraffe
from tests.meshes.shapes import prepared


def limbs(partner, margin=0.1):
    """Limbs of which only the partners count."""
    count = len(partner)
    nothing = np.zeros(count)
    ways = np.zeros((count, count))
    return Limbs(ways, np.zeros((count,) * 3), nothing, partner, partner, nothing, margin, np.arange(count), ways)


def layout_of(vertices, faces):
    points, surface = prepared(vertices, faces)
    heat = HeatMethod(surface, 0.005)
    landmarks, distances = farthest_points(heat, np.array([0]), 60, monitor=Monitor())
    return laid_out(distances, landmarks, points, faces, limbs(np.arange(1))).points


def test_handedness_tells_a_ball_from_a_tie():
    vertices, faces = shapes.sphere(4)
    assert handedness(vertices, faces) == pytest.approx(4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1.0, 1.0, -1.0], faces) == pytest.approx(-4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1.0, 1.0, 0.0], faces) == 0


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


SOLID = 0.3 * np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])  # a tetrahedron in the middle
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
TRUNK = np.array([[1.0, 2, 0], [-1, 2, 0], [1, -2, 0], [-1, -2, 0]])  # four ends: left and right, in front and behind
ACROSS = np.array([1, 0, 3, 2])


def depth_of(ends, partner, solid, margin=0.1):
    """The depth of a layout of ends and a solid, whose distances are straight: scaling restores it."""
    points = np.vstack([ends, solid])
    landmarks = np.arange(len(points))
    return laid_out(cdist(points, points), landmarks, points, FACES + len(ends), limbs(partner, margin)).depth


@pytest.mark.parametrize("size", [0.01, 1.0, 3.0])
def test_a_layout_that_a_half_turn_exchanges_is_a_tie_whatever_its_volume(size):
    twisted = TRUNK + np.outer([0.5, -0.5, -0.5, 0.5], [0, 0, 1])
    assert depth_of(twisted, ACROSS, size * SOLID) == 0
    assert depth_of(twisted * [1, 1, -1], ACROSS, size * SOLID) == 0


@pytest.mark.parametrize("size", [0.1, 1.0, 3.0])
def test_a_layout_that_a_mirror_exchanges_is_real_whatever_its_volume(size):
    bowl = np.vstack([TRUNK + np.array([0, 0, 0.5]), [0, 4, -2]])
    assert depth_of(bowl, np.append(ACROSS, 4), size * SOLID) == 1


@pytest.mark.parametrize(("size", "expected"), [(0.1, 0), (3.0, 1)])
def test_without_sides_or_with_all_ends_in_a_plane_the_volume_tells(size, expected):
    solid = size * SOLID
    assert depth_of(TRUNK, ACROSS, solid) == expected
    assert depth_of(TRUNK / 4, np.arange(4), solid) == expected
    bowl = np.vstack([TRUNK + np.array([0, 0, 0.5]), [0, 4, -2]]) / 4
    assert depth_of(bowl, np.append(ACROSS, 4), solid, margin=0.005) == expected  # another swap fits as well
    twisted = np.array([[1.0, 2, 0], [-1, 2, 0], [0, -2, 1], [0, -2, -1]])
    assert depth_of(twisted, np.array([1, 0, 2, 3]), solid) == expected  # one pair, and feet taken for head and tail


@pytest.mark.parametrize("neck", [0.0, 0.5])
def test_the_legs_of_a_giraffe_spread_to_both_sides_however_its_neck_leans(neck):
    vertices, faces = giraffe(neck)
    form = canonical_form(vertices, faces)
    ends = form.vertices[form.feature_points]
    far = np.linalg.norm(ends[:, None] - ends, axis=2)
    head, tail = 0, 1
    for left, right in ((2, 3), (4, 5)):
        np.testing.assert_allclose(far[[head, tail], left], far[[head, tail], right], rtol=0.08)
    assert form.asymmetry < 0.02
