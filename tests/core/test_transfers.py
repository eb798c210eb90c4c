"""What a match carries over: weights, UV maps across seams, deformations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import (
    InvalidMeshError,
    Match,
    match,
    transferred,
    transferred_corners,
    transferred_labels,
    transferred_shape,
)
from addon.core.mesh.closest_points import closest_points
from addon.core.mesh.islands import island_labels
from addon.core.mesh.tables import rows_in
from tests.meshes.shapes import cylinder, figure, grid, permuted


def known_match(faces, other_faces, on, weights, other_count):
    """A match that is given, of vertices with points on triangles."""
    nearest = other_faces[on, weights.argmax(axis=1)]
    return Match(nearest, on, weights, np.ones(len(on)), [], other_faces, other_count, {}, [], [])


def onto_itself(faces, count):
    """The match of a mesh with itself: each vertex in a triangle that has it."""
    on = np.zeros(count, dtype=int)
    on[faces.ravel()] = np.repeat(np.arange(len(faces)), 3)
    return known_match(faces, faces, on, (faces[on] == np.arange(count)[:, None]).astype(float), count)


def test_rows_are_found_where_they_are():
    rng = np.random.default_rng(0)
    table = np.unique(rng.integers(0, 9, (200, 3)), axis=0)
    order = rng.permutation(len(table))
    assert np.array_equal(rows_in(table[order], table), order)
    assert rows_in(np.array([[9, 9, 9]]), table).tolist() == [-1]


def test_islands_end_where_values_jump():
    points, faces = grid(7, 5)
    plain = points[faces][:, :, :2]
    assert np.ptp(island_labels(faces, plain)) == 0
    right = points[faces].mean(axis=1)[:, 0] > 0.5
    cut = plain + np.where(right, 3.0, 0.0)[:, None, None]
    labels = island_labels(faces, cut)
    assert len(np.unique(labels)) == 2
    assert len(np.unique(labels[right])) == len(np.unique(labels[~right])) == 1


def test_a_uv_map_with_a_seam_is_carried_whole():
    points, faces = cylinder(24, 12)
    around = np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi) + 0.5
    place = np.column_stack([around, points[:, 2]])[faces]  # (m, 3, 2)
    over = np.ptp(place[:, :, 0], axis=1) > 0.5  # the seam: they go on beyond 1
    place[:, :, 0] += (over[:, None] & (place[:, :, 0] < 0.5)).astype(float)
    corners = np.arange(3 * len(faces)).reshape(-1, 3)
    shuffled, others, old = permuted(points, faces)
    same = onto_itself(faces, len(points))
    here = match_through(same, old)
    found = transferred_corners(
        here, np.repeat(np.arange(len(others)), 3), others.ravel(), points, corners, place.reshape(-1, 2), faces.ravel()
    ).reshape(-1, 3, 2)
    stretch = np.ptp(found[:, :, 0], axis=1)
    assert stretch.max() < 1.5 / 24  # no triangle lies across the whole map
    true = np.arctan2(shuffled[:, 1], shuffled[:, 0])[others] / (2 * np.pi) + 0.5
    away = np.abs(found[:, :, 0] - true)
    assert np.minimum(away, np.abs(away - 1)).max() < 0.1 / 24  # beyond the seam a straight line goes on
    np.testing.assert_allclose(found[:, :, 1], shuffled[others][:, :, 2], atol=1e-9)


def match_through(same, old):
    """The match of a mesh under other numbers, where `old` is that of each vertex."""
    return Match(
        same.vertices[old], same.faces[old], same.weights[old], same.confidence[old], [], same.other_faces,
        same.other_count, {}, [], [],
    )  # fmt: skip


def test_a_polygon_across_a_seam_takes_one_side_of_it():
    points, faces = grid(5, 5)
    right = points[faces].mean(axis=1)[:, 0] > 0.5
    place = points[faces][:, :, :2] + np.where(right, 3.0, 0.0)[:, None, None]
    corners = np.arange(3 * len(faces)).reshape(-1, 3)
    wanted = np.column_stack([np.clip(points[:, 0] + 0.1, 0, 1), points[:, 1:]])
    found = closest_points(points, faces, wanted)
    matched = known_match(faces, faces, found.faces, found.weights, len(points))
    own = (np.repeat(np.arange(len(faces)), 3), faces.ravel())
    got = transferred_corners(matched, *own, points, corners, place.reshape(-1, 2), faces.ravel()).reshape(-1, 3, 2)
    assert np.ptp(got[:, :, 0], axis=1).max() < 0.5
    assert {round(float(each)) for each in np.floor(got[:, :, 0].mean(axis=1) / 3)} == {0, 1}


def test_corners_without_a_match_get_nothing():
    points, faces = grid(3, 3)
    matched = onto_itself(faces, len(points))
    matched.faces[4] = -1
    matched.weights[4] = 0
    corners = np.arange(3 * len(faces)).reshape(-1, 3)
    found = transferred_corners(
        matched, np.repeat(np.arange(len(faces)), 3), faces.ravel(), points, corners, np.ones((len(corners) * 3, 1)),
        faces.ravel(),
    )  # fmt: skip
    assert np.array_equal(found.ravel() == 0, faces.ravel() == 4)


def test_the_number_of_corners_is_checked():
    points, faces = grid(3, 3)
    corners = np.arange(3 * len(faces)).reshape(-1, 3)
    own = (np.repeat(np.arange(len(faces)), 3), faces.ravel())
    with pytest.raises(InvalidMeshError, match="per corner of the other mesh, 24"):
        transferred_corners(onto_itself(faces, 9), *own, points, corners, np.ones((5, 2)), faces.ravel())


def test_a_deformation_is_turned_and_sized_like_the_body():
    points, faces = figure(14)
    turn, size = Rotation.from_euler("xyz", [0.4, -0.9, 2.0]).as_matrix(), 2.5
    bulge = points + 0.2 * np.sin(2 * points[:, [1, 2, 0]])
    found = transferred_shape(onto_itself(faces, len(points)), size * points @ turn, faces, points, bulge)
    np.testing.assert_allclose(found, size * bulge @ turn, atol=1e-6)


def test_a_deformation_follows_the_limb_that_it_is_on():
    points, faces = figure(16)
    angle = np.clip(points[:, 0] - 0.6, 0, 0.6) * 1.5  # a limb bent in another pose
    cos, sin = np.cos(angle), np.sin(angle)
    bent = np.column_stack(
        [points[:, 0], cos * points[:, 1] - sin * points[:, 2], sin * points[:, 1] + cos * points[:, 2]]
    )
    tip = points[:, 0] > 1.3
    moved = points + np.where(tip, 0.3, 0.0)[:, None] * [0, 0, 1]
    found = transferred_shape(onto_itself(faces, len(points)), bent, faces, points, moved)
    way = (found - bent)[points[:, 0] > 1.5]
    expected = np.array([0, -np.sin(0.9), np.cos(0.9)]) * 0.3
    assert np.linalg.norm(way - expected, axis=1).mean() < 0.1
    assert np.linalg.norm((found - bent)[points[:, 0] < 0.5], axis=1).max() == 0


def test_weights_found_by_a_match_come_back_from_other_triangles():
    points, faces = figure(14)
    others, other_faces = figure(15)
    found = match(points, faces, others, other_faces)

    def smooth(places):
        return np.column_stack([0.5 + 0.5 * np.tanh(places[:, 0]), 0.5 - 0.5 * np.tanh(places[:, 0])])

    carried = transferred(found, smooth(others))
    np.testing.assert_allclose(carried.sum(axis=1), 1.0)
    assert np.abs(carried - smooth(points)).mean() < 0.05


def with_a_slit(points, faces):
    """Cut a figure half around its trunk, as closed lips are cut: the vertices, the triangles, which are above."""
    above = points[faces].mean(axis=1)[:, 2] > 0.05
    here = np.zeros((2, len(points)), dtype=bool)
    for side, some in enumerate((faces[~above], faces[above])):
        here[side, some] = True
    lips = np.flatnonzero(here.all(axis=0) & (points[:, 1] > 0.02) & (np.abs(points[:, 0]) < 0.3))
    copy = np.arange(len(points))
    copy[lips] = len(points) + np.arange(len(lips))
    cut = np.where(above[:, None], copy[faces], faces)
    upper = np.zeros(len(points) + len(lips), dtype=bool)
    upper[cut[above]] = True
    upper[lips] = False
    return np.concatenate([points, points[lips]]), cut, upper, lips


@pytest.fixture(scope="module")
def lips():
    """A figure with a slit, the same under other numbers, and their match."""
    points, faces, upper, closed = with_a_slit(*figure(16))
    assert len(closed) > 2
    here, own, old = permuted(points, faces)
    return points, faces, upper, closed, here, own, old, match(here, own, points, faces)


def test_lips_that_are_closed_keep_values_of_their_own(lips):
    points, _, upper, closed, _, _, old, found = lips
    jaw = np.where(upper, 0.0, 1.0)
    at_lips = np.isin(old, closed) | (old >= len(points) - len(closed))
    np.testing.assert_allclose(transferred(found, jaw)[at_lips], jaw[old][at_lips], atol=0.35)
    one = transferred(found, points)  # the same on both sides: copies get one value
    place = {number: tuple(value) for number, value in zip(old.tolist(), one, strict=True)}
    assert all(place[lip] == place[len(points) - len(closed) + number] for number, lip in enumerate(closed.tolist()))


def test_a_key_opens_closed_lips_and_no_other_seam(lips):
    points, _, upper, closed, here, own, old, found = lips
    opened = points + np.where(upper, 0.0, -0.1)[:, None] * [0, 0, 1]
    moved = transferred_shape(found, here, own, points, opened)
    way = np.empty(len(points))
    way[old] = (moved - here)[:, 2]
    gap = way[-len(closed) :] - way[closed]
    assert (gap > 0.05).all()
    grown = np.empty_like(points)
    grown[old] = transferred_shape(found, here, own, points, 1.1 * points)
    np.testing.assert_array_equal(grown[-len(closed) :], grown[closed])


def test_a_split_source_gives_what_the_whole_one_does():
    points, faces = figure(14)
    front = points[faces].mean(axis=1)[:, 1] > 0
    both = np.intersect1d(faces[front], faces[~front])
    copy = np.arange(len(points))
    copy[both] = len(points) + np.arange(len(both))
    cut, split = np.where(front[:, None], copy[faces], faces), np.concatenate([points, points[both]])
    here, own, _ = permuted(points, faces)
    map_of = np.where(front[:, None, None], 2.0, 0.0) + points[faces][:, :, [0, 2]]
    corners = np.arange(faces.size).reshape(-1, 3)
    own_corners = (np.repeat(np.arange(len(own)), 3), own.ravel())
    results = []
    for there, triangles in ((points, faces), (split, cut)):
        found = match(here, own, there, triangles)
        results.append((
            transferred_corners(found, *own_corners, there, corners, map_of.reshape(-1, 2), triangles.ravel()),
            transferred_labels(found, *own_corners, triangles, front.astype(int)),
            transferred(found, np.sin(3 * there)),
        ))  # fmt: skip
    for whole, parts in zip(*results, strict=True):
        np.testing.assert_allclose(parts, whole, atol=1e-9)
