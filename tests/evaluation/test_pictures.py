import numpy as np
import pytest

from addon.core import feature_patches
from addon.evaluation.pictures import drawn, upright
from tools.figures.features import occluded, repeatability
from tools.figures.models import own_models


def shown(image):
    return (image < 255).any(axis=2)


def test_a_ball_is_a_disc_and_red_when_inside_out(sphere):
    vertices, faces = sphere
    image = drawn(vertices, faces, size=120)
    assert shown(image).mean() == pytest.approx(np.pi / 4 / 1.08**2, rel=0.04)  # whole pixels
    assert (np.ptp(image[shown(image)].astype(int), axis=1) < 10).mean() > 0.97  # grey, but for the rim
    inside = drawn(vertices, faces[:, ::-1], size=120)
    red = inside[shown(inside)].astype(int)
    assert (red[:, 0] > 2 * red[:, 1]).mean() > 0.97
    np.testing.assert_array_equal(drawn(vertices, faces, size=120), image)


def test_shapes_are_shown_at_their_widest(rotation, sphere):
    flat = sphere[0] * [1.0, 3.0, 0.2]
    seen = (flat @ rotation) @ upright(flat @ rotation)
    np.testing.assert_allclose(np.ptp(seen, axis=0), [2.0, 6.0, 0.4], rtol=0.05)
    assert np.linalg.det(upright(flat @ rotation)) == pytest.approx(1)


def test_repeatability_counts_partners_on_both_sides():
    _, vertices, faces = own_models()["figure"][0]
    points = feature_patches(vertices, faces).feature_points
    assert repeatability(vertices, faces, points, points) == 1
    assert repeatability(vertices, faces, points, points[:3]) == pytest.approx((3 + 3) / (len(points) + 3))
    half, triangles, used = occluded(vertices, faces, "figure")
    assert len(half) < len(vertices)
    np.testing.assert_array_equal(half, vertices[used])
    assert triangles.max() == len(half) - 1
