"""The map between two surfaces."""

import numpy as np
import pytest

from addon.core.matching.spectral_map import first_map, on_triangles, refined
from addon.core.matching.starts import Start
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor

QUARTER = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
TURN *= np.sign(np.linalg.det(TURN))


def moved(body, rotation, shift):
    """The same surface with its form elsewhere."""
    return body._replace(
        form=body.form @ rotation + shift,
        normals=body.normals @ rotation,
        whole_form=body.whole_form @ rotation + shift,
    )


def nearest(here, there):
    return np.linalg.norm(here[:, None] - there, axis=2).argmin(axis=1)


def test_the_first_map_goes_by_distances_places_and_normals(body, renumbered):
    other, old = renumbered
    image = np.array([int(np.flatnonzero(old[other.features] == each)[0]) for each in body.features])
    image[1] = -1
    other = moved(other, TURN, [0.1, 0.2, 0.3])
    way = Start(image, TURN, np.array([0.15, 0.2, 0.3]))  # not quite
    known = np.flatnonzero(image >= 0)
    here = np.column_stack(
        [body.limbs.to_features[:, known], 0.3 * (body.form @ TURN + way.shift), 0.08 * body.normals @ TURN]
    )
    there = np.column_stack([other.limbs.to_features[:, image[known]], 0.3 * other.form, 0.08 * other.normals])
    expected = nearest(here, there)
    assert first_map(body, other, way, Monitor()).tolist() == expected.tolist()
    rows = np.arange(5, len(body.form), 4)
    assert first_map(body, other, way, Monitor(), rows=rows).tolist() == expected[rows].tolist()


def test_the_first_map_knows_limbs_of_other_lengths(body):
    """A body on which all ways are longer is still itself."""
    limbs = body.limbs
    longer = limbs._replace(distances=1.6 * limbs.distances, to_features=1.6 * limbs.to_features)
    way = Start(np.arange(len(body.features)), np.eye(3), np.zeros(3))
    mapped = first_map(body, body._replace(limbs=longer), way, Monitor())
    assert mapped.tolist() == first_map(body, body, way, Monitor()).tolist()
    uneven = limbs._replace(distances=limbs.distances * [[0.6], [1], [1], [1], [1]] * [0.6, 1, 1, 1, 1])
    assert (first_map(body, body._replace(limbs=uneven), way, Monitor()) != mapped).any()


def test_one_common_feature_point_is_enough_for_its_distances(body):
    """The first point of the other surface counts like any other."""
    image = np.full(len(body.features), -1)
    image[2] = 0
    way = Start(image, np.eye(3), np.zeros(3))
    here = np.column_stack([body.limbs.to_features[:, 2], 0.3 * body.form, 0.08 * body.normals])
    there = np.column_stack([body.limbs.to_features[:, 0], 0.3 * body.form, 0.08 * body.normals])
    assert first_map(body, body, way, Monitor()).tolist() == nearest(here, there).tolist()


def test_without_common_feature_points_places_count_and_normals_as_before(body):
    way = Start(np.full(len(body.features), -1), np.eye(3), np.array([0.03, -0.02, 0.01]))
    weight = 0.08 / 0.3
    here = np.column_stack([body.form + way.shift, weight * body.normals])
    expected = nearest(here, np.column_stack([body.form, weight * body.normals]))
    assert first_map(body, body, way, Monitor()).tolist() == expected.tolist()


@pytest.mark.parametrize("sampled", [False, True])
def test_refining_mends_a_map_that_is_off(body, renumbered, sampled):
    other, old = renumbered
    truth = np.argsort(old)
    rows = np.arange(0, len(body.form), 2) if sampled else None
    at = np.arange(len(body.form)) if rows is None else rows
    chance = np.random.default_rng(0)
    begin = truth[at].copy()
    wrong = chance.random(len(at)) < 0.2
    begin[wrong] = chance.integers(0, len(old), wrong.sum())
    refined_map = refined(body, other, begin, (10, 20, 40), 0.3, Monitor(), rows=rows)
    off = np.linalg.norm(other.form[refined_map] - other.form[truth[at]], axis=1)
    before = np.linalg.norm(other.form[begin] - other.form[truth[at]], axis=1)
    assert before.mean() > 0.05
    assert off.mean() < 0.01
    assert np.quantile(off, 0.99) < 0.1


def test_the_exact_map_stays_wherever_the_other_form_lies(body, renumbered):
    other, old = renumbered
    truth = np.argsort(old)
    elsewhere = moved(other, TURN, [3.0, -2, 1])
    assert refined(body, elsewhere, truth, (20, 40), 0.3, Monitor()).tolist() == truth.tolist()


def test_a_form_moves_smoothly_to_one_that_is_bent(body):
    """Bending one form is followed: without it places would be off by as much."""
    along = body.form[:, 0] - body.form[:, 0].min()
    bent = body.form + np.column_stack([np.zeros_like(along), 0.4 * along**2, np.zeros_like(along)])
    other = body._replace(form=bent)
    truth = np.arange(len(bent))
    near = 30.0  # places alone decide
    mapped = refined(body, other, truth, (80,), near, Monitor())
    assert (mapped == truth).mean() > 0.9
    stiff = refined(body, other, truth, (2,), near, Monitor())  # one constant function: a motion only
    assert (stiff == truth).mean() < (mapped == truth).mean() - 0.2


def test_on_triangles_ends_in_corners_where_the_surfaces_are_the_same(body, renumbered):
    other, old = renumbered
    truth = np.argsort(old)
    points = on_triangles(body, other, truth, 60, 0.3, Monitor())
    assert points.nearest_corners(other.faces).tolist() == truth.tolist()
    np.testing.assert_allclose(points.on(other.form, other.faces), body.form, atol=1e-5)


def test_maps_can_be_cancelled(body):
    with pytest.raises(CancelledError):
        refined(body, body, np.arange(len(body.form)), (5,), 0.3, Monitor(cancelled=lambda: True))
