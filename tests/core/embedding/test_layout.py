"""The layout of the limbs, and whether it tells a surface from its mirror image."""

import numpy as np
import pytest

from addon.core import canonical_form
from addon.core.distances.farthest_points import farthest_points
from addon.core.distances.heat import HeatMethod
from addon.core.embedding.layout import certainty, handedness, laid_out
from addon.core.embedding.start import landmark_distances
from addon.core.measures.alignment import rigid_fit
from addon.core.run.monitor import Monitor
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from tests.meshes import shapes
from tests.meshes.animals import giraffe
from tests.meshes.shapes import prepared


def layout_of(vertices, faces):
    points, surface = prepared(vertices, faces)
    spectrum = compute_spectrum(stiffness(surface), mass(surface), 60)
    heat = HeatMethod(surface, 0.005, refine=False)
    landmarks, distances = farthest_points(heat, np.array([0]), heat.distances([0]), 60, monitor=Monitor())
    return laid_out(landmark_distances(distances, landmarks, spectrum), landmarks, points, faces, np.arange(1), 0.0)[0]


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


TRUNK = np.array([[1.0, 2, 0], [-1, 2, 0], [1, -2, 0], [-1, -2, 0]])  # four ends: left and right, in front and behind
ACROSS = np.array([1, 0, 3, 2])


@pytest.mark.parametrize("volume", [0.3, 1.0, 5.0])
def test_a_layout_that_a_half_turn_exchanges_is_a_tie_whatever_its_volume(volume):
    twisted = TRUNK + np.outer([0.5, -0.5, -0.5, 0.5], [0, 0, 1])
    assert certainty(volume, twisted, ACROSS, 0.1) == 0
    assert certainty(volume, twisted * [1, 1, -1], ACROSS, 0.1) == 0


@pytest.mark.parametrize(("volume", "expected"), [(0.1, 0), (0.3, 0.5), (0.5, 1), (5.0, 1)])
def test_a_layout_that_a_mirror_exchanges_is_told_by_a_small_volume(volume, expected):
    bowl = np.vstack([TRUNK + np.array([0, 0, 0.5]), [0, 4, -2]])
    assert certainty(volume, bowl, np.append(ACROSS, 4), 0.1) == pytest.approx(expected)


@pytest.mark.parametrize(("volume", "expected"), [(0.5, 0), (1.2, 0.5), (2.0, 1)])
def test_without_sides_or_with_all_ends_in_a_plane_only_the_volume_tells(volume, expected):
    assert certainty(volume, TRUNK, ACROSS, 0.1) == pytest.approx(expected)
    assert certainty(volume, np.random.default_rng(3).normal(size=(4, 3)), np.arange(4), 0.0) == pytest.approx(expected)
    assert certainty(volume, np.zeros((2, 3)), np.array([1, 0]), 0.1) == pytest.approx(expected)


@pytest.mark.parametrize(("lead", "expected"), [(0.0, 1), (0.01, 0.5), (0.05, 0)])
def test_where_another_swap_fits_nearly_as_well_the_volume_tells(lead, expected):
    twisted = TRUNK + np.outer([0.5, -0.5, -0.5, 0.5], [0, 0, 1])
    assert certainty(5.0, twisted, ACROSS, lead) == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(20))
def test_certainty_does_not_jump(seed):
    one, other = np.random.default_rng(seed).normal(size=(2, 5, 3))
    way = np.linspace(0, 1, 3001)
    along = [certainty(0.1 + 2 * t, one * (1 - t) + other * t, np.append(ACROSS, 4), 0.1) for t in way]
    assert np.abs(np.diff(along)).max() < 0.05
    assert np.ptp(along) > 0.1


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
