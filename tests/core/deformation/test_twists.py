"""Twists of limbs, measured against the body and taken back."""

import numpy as np
import pytest

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.deformation.twists import untwisted
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes, tubes

AROUND, ALONG = 24, 100


def tube(curve):
    """A tube of unit area, the centres of its caps, and the distances of all vertices from them, along the axis."""
    vertices, faces = tubes.tube(curve, AROUND, ALONG)
    scale = np.sqrt(surface_area(vertices, faces))
    place = np.append(np.repeat(np.linspace(0, tubes.LENGTH, ALONG + 1), AROUND), [0, tubes.LENGTH]) / scale
    points = vertices / scale
    body = ElasticBody(triangulated(points, faces), points, faces)
    return body, np.array([len(points) - 2, len(points) - 1]), np.column_stack([place, tubes.LENGTH / scale - place])


def twisted(points, place, degrees, first, last):
    """Points turned about the axis of x, from nothing at one place to an angle at another."""
    angle = np.radians(degrees) * np.clip((place / place.max() - first) / (last - first), 0, 1)
    y, z = points[:, 1], points[:, 2]
    return np.column_stack([points[:, 0], np.cos(angle) * y - np.sin(angle) * z, np.sin(angle) * y + np.cos(angle) * z])


def off(form, wanted):
    """The largest distance from a shape, where the two fit best."""
    turn, shift = rigid_fit(form, wanted)
    return np.linalg.norm(form @ turn + shift - wanted, axis=1).max()


@pytest.mark.parametrize("degrees", [60, 150, -150])
@pytest.mark.parametrize("curve", ["straight", "S", "three quarters"])
def test_a_twist_is_taken_back(curve: str, degrees: int):
    straight = tube(tubes.CURVES["straight"])[0].points
    body, features, away = tube(tubes.CURVES[curve])
    form = twisted(straight, away[:, 0], degrees, 0.3, 0.7)
    assert off(form, straight) > 0.03
    assert off(untwisted(body, form, features, away), straight) < 0.014


def test_a_twist_across_the_border_of_two_limbs_is_shared_by_them():
    body, features, away = tube(tubes.CURVES["straight"])
    form = twisted(body.points, away[:, 0], 150, 0.4, 0.6)
    assert off(untwisted(body, form, features, away), body.points) < 0.25 * off(form, body.points)


def test_nothing_depends_on_how_body_and_form_lie(rotation):
    body, features, away = tube(tubes.CURVES["S"])
    form = twisted(tube(tubes.CURVES["straight"])[0].points, away[:, 0], 120, 0.2, 0.5)
    faces = tubes.tube(tubes.CURVES["S"], AROUND, ALONG)[1]
    moved = body.points @ rotation + 3.0
    other = ElasticBody(triangulated(moved, faces), moved, faces)
    one, two = untwisted(body, form, features, away), untwisted(other, form @ rotation.T - 1.0, features, away)
    assert off(two, one) < 1e-6


def test_what_is_not_twisted_and_what_fits_no_rotation_stay():
    body, features, away = tube(tubes.CURVES["S"])
    straight = tube(tubes.CURVES["straight"])[0].points
    assert off(untwisted(body, straight, features, away), straight) < 0.004
    crumpled = straight * [1.0, 0.2, 1.5]
    form = twisted(crumpled, away[:, 0], 150, 0.3, 0.7)
    assert off(untwisted(body, form, features, away), form) < 1e-6


def test_limbs_shorter_than_a_section_stay():
    vertices, faces = shapes.sphere(1)
    points = vertices / np.sqrt(surface_area(vertices, faces))
    body = ElasticBody(triangulated(points, faces), points, faces)
    far = np.linalg.norm(points[:, None] - points, axis=2)[:, :6]
    assert off(untwisted(body, points * 1.1, np.arange(6), far), points * 1.1) < 1e-6


def test_feature_points_in_the_same_place_stay():
    body, features, away = tube(tubes.CURVES["S"])
    form = twisted(tube(tubes.CURVES["straight"])[0].points, away[:, 0], 150, 0.3, 0.7)
    assert off(untwisted(body, form, features[[0, 0]], away[:, [0, 0]]), form) < 1e-6


def test_distances_below_zero_lie_before_the_tip():
    """On a mesh with spikes heat distances can be negative, by several sections."""
    body, features, away = tube(tubes.CURVES["straight"])
    form = twisted(body.points, away[:, 0], 60, 0.3, 0.7)
    away[away[:, 0].argsort()[1:30], 0] = -0.5
    away[features] = np.maximum(away[features], 0)
    assert off(untwisted(body, form, features, away), body.points) < 0.014
