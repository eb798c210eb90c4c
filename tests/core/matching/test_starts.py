"""Where a match may begin."""

import numpy as np
import pytest

from addon.core.matching import starts as module
from addon.core.matching.starts import starts
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor


def rows_of(body):
    return np.arange(0, len(body.form), 3)


def angle(one, two):
    return np.degrees(np.arccos(np.clip((np.trace(one.T @ two) - 1) / 2, -1, 1)))


def first_limbs(body, count):
    limbs = body.limbs
    square = np.ix_(range(count), range(count))
    return body._replace(
        limbs=limbs._replace(
            distances=limbs.distances[square],
            handedness=limbs.handedness[:count, :count, :count],
            adf=limbs.adf[:count],
            partner=limbs.partner[:count],
            side=limbs.side[:count],
            along=limbs.along[:count],
            features=limbs.features[:count],
            to_features=limbs.to_features[:, :count],
        )
    )


def test_a_body_lies_on_itself_first_and_every_way_is_a_proper_motion(body):
    ways = starts(body, body, rows_of(body), Monitor())
    np.testing.assert_allclose(ways[0].rotation, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(ways[0].shift, 0, atol=1e-9)
    assert ways[0].image.tolist() == list(range(len(body.features)))
    for way in ways:
        np.testing.assert_allclose(way.rotation @ way.rotation.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(way.rotation) == pytest.approx(1)


def test_each_assignment_is_tried_once(body):
    ways = starts(body, body, rows_of(body), Monitor())
    images = [tuple(way.image) for way in ways if (way.image >= 0).all()]
    assert len(set(images)) >= 2
    by_limbs = images[: len(set(images))]
    assert len(by_limbs) == len(set(by_limbs))


def test_with_each_assignment_its_mirror_image_is_tried(body, monkeypatch):
    """With one feature point fewer the likeliest ones could all be of one side, or of arms and legs that disagree."""
    some, pair = first_limbs(body, 4), body.limbs.partner
    likeliest = module.feature_assignments(some.limbs, body.limbs, 1)[0][0]
    monkeypatch.setattr(module, "feature_assignments", lambda *given: [(likeliest, 0.1)])
    images = {tuple(way.image) for way in starts(some, body, rows_of(body), Monitor())}
    assert tuple(pair[likeliest]) != tuple(likeliest)
    assert {tuple(likeliest), tuple(pair[likeliest])} <= images


def test_another_numbering_is_seen_through(body, renumbered):
    other, old = renumbered
    way = starts(body, other, rows_of(body), Monitor())[0]
    placed = body.form @ way.rotation + way.shift
    np.testing.assert_allclose(placed[old], other.form, atol=1e-6)
    assert old[other.features[way.image]].tolist() == body.features.tolist()


def test_without_feature_points_the_four_turns_about_the_axes_are_left(body):
    blind = body._replace(limbs=body.limbs.sorted_by(np.arange(0)))
    ways = starts(blind, blind, rows_of(body), Monitor())
    assert 1 < len(ways) <= 4
    assert min(angle(way.rotation, np.eye(3)) for way in ways) < 1e-3
    for number, way in enumerate(ways):
        assert way.image.tolist() == []
        assert all(angle(way.rotation, each.rotation) >= 25 for each in ways[:number])


def test_turns_about_the_axes_tell_the_tips_by_their_places(body):
    """Where thickness is unlike everywhere no assignment leads anywhere, and tips get the nearest."""
    count = len(body.features) - 1
    some = first_limbs(body, count)
    blind = {"adf": 100 * some.limbs.adf, "partner": np.arange(count), "side": np.zeros(count, dtype=np.int64)}
    some = some._replace(limbs=some.limbs._replace(**blind))
    away = body._replace(form=body.form + np.array([0.0, 3.0, 0.0]))
    ways = starts(some, away, rows_of(body), Monitor())
    nearest = min(ways, key=lambda way: angle(way.rotation, np.eye(3)))
    assert angle(nearest.rotation, np.eye(3)) < 1e-3
    np.testing.assert_allclose(nearest.shift, [0, 3, 0], atol=1e-6)
    assert nearest.image.tolist() == list(range(len(some.features)))


def test_it_can_be_cancelled(body):
    with pytest.raises(CancelledError):
        starts(body, body, rows_of(body), Monitor(cancelled=lambda: True))
