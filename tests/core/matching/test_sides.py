"""Which side of one surface is which of another."""

import numpy as np
import pytest

from addon.core import matches
from addon.core.matching import sides as module
from addon.core.matching.sides import Side, sides
from addon.core.matching.starts import Start
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.far_points import far_points
from addon.core.run.monitor import Monitor


def test_a_body_is_most_like_itself_and_the_best_way_comes_first(body, renumbered):
    other, old = renumbered
    ways = sides(body, other, Monitor())
    costs = [way.cost for way in ways]
    assert costs == sorted(costs)
    assert np.isnan(ways[0].strain)  # no other comes close
    assert ways[0].score < -4
    placed = body.form @ ways[0].start.rotation + ways[0].start.shift
    np.testing.assert_allclose(placed[old], other.form, atol=1e-6)


def test_progress_ends_at_the_last_way(body):
    told = []
    sides(body, body, Monitor(lambda share, stage: told.append(share)))
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)
    assert told[0] > 0


def test_ways_that_lead_to_one_map_are_one_side(body):
    rows = np.arange(len(body.form))
    ways = sides(body, body, Monitor())
    places = [body.form @ way.start.rotation + way.start.shift for way in ways]
    assert len(ways) > 1
    for number, one in enumerate(places):
        for two in places[:number]:
            assert np.linalg.norm((one - two)[rows], axis=1).mean() > 0.05


def test_the_score_is_distance_signature_and_curvature(body, renumbered):
    other, old = renumbered
    rows = np.arange(0, len(body.form), 7)
    partner = np.argsort(old)[rows]
    wrong = np.roll(partner, 3)
    for image in (partner, wrong):
        turn, shift = rigid_fit(body.form[rows], other.form[image])
        left = np.sqrt((np.linalg.norm(body.form[rows] @ turn + shift - other.form[image], axis=1) ** 2).mean())
        changed = np.sqrt((np.linalg.norm(body.signature[rows] - other.signature[image], axis=1) ** 2).mean())
        alike = [np.corrcoef(body.curvature[rows, k], other.curvature[image, k])[0, 1] for k in (0, 1)]
        if image is wrong:
            expected = np.log(left) + 2 * changed - 2 * np.mean(alike)
            assert module._score(body, other, rows, image) == pytest.approx(expected)
        else:
            assert module._score(body, other, rows, image) < np.log(1e-6)


def test_ends_of_limbs_that_meet_none_count(body):
    rows = np.arange(len(body.form))
    assert module._ends_apart(body, body, rows, rows) == pytest.approx(0, abs=1e-9)
    tips, away = body.features, body.limbs.to_features
    crotch = int(np.argmax(away.min(axis=1)))
    lost = rows.copy()
    lost[tips[0]] = crotch  # one limb ends where none does
    missed = np.delete(away[tips[0]], 0).min()
    missed = min(missed, away[crotch, 0])
    expected = (away[crotch].min() + missed) / len(tips) / 2
    assert module._ends_apart(body, body, rows, lost) == pytest.approx(expected)
    nothing = body._replace(limbs=body.limbs._replace(features=tips[:0], to_features=away[:, :0]))
    assert module._ends_apart(nothing, body, rows, rows) == 0.0


def test_correlation_is_that_of_pearson_and_none_of_constants():
    one, two = np.random.default_rng(0).normal(size=(2, 50)) + 3
    assert module._correlation(one, two + one) == pytest.approx(np.corrcoef(one, two + one)[0, 1])
    assert module._correlation(np.ones(4), np.arange(4.0)) == 0.0


def test_samples_are_the_farthest_from_each_other():
    points = np.random.default_rng(1).normal(size=(200, 3)) + 5
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    while len(chosen) < 20:
        far = np.min([np.linalg.norm(points - points[each], axis=1) for each in chosen], axis=0)
        chosen.append(int(np.argmax(far)))
    assert far_points(points, 20).tolist() == chosen
    assert far_points(points, 200).tolist() == list(range(200))
    assert far_points(points, 300).tolist() == list(range(200))


@pytest.mark.parametrize(
    ("scores", "strains", "order"),
    [
        ([-4.2, -4.1, -3.0], {-4.2: 0.09, -4.1: 0.08}, [-4.1, -4.2, -3.0]),  # strain decides among the close
        ([-4.2, -4.1, -3.0], {-4.2: 0.08, -4.1: 0.09}, [-4.2, -4.1, -3.0]),
        ([-4.2, -4.2, -4.1, -4.0], {-4.2: 0.5, -4.1: 0.1}, [-4.1, -4.2, -4.2, -4.0]),  # of the first three at most
        ([-5.0, -4.5], {}, [-5.0, -4.5]),
        ([-3.0], {}, [-3.0]),
    ],
)
def test_matches_with_close_scores_are_sorted_by_strain(body, monkeypatch, scores, strains, order):
    monkeypatch.setattr(module, "fit_strain", lambda one, other, start, monitor: strains[start])
    told = []
    monitor = Monitor(lambda share, stage: told.append(share))
    found = module._by_strain(body, body, [Side(score, score) for score in scores], monitor)
    assert [side.score for side in found] == order
    assert {side.score: side.strain for side in found if not np.isnan(side.strain)} == strains
    assert told[-1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("strain", "facing", "rival", "told"),
    [
        (0.16, 0.5, 0.20, True),  # unlike bodies of which one hardly tells left from right: a guess
        (0.16, 2.0, 0.20, False),  # both tell
        (0.16, 2.0, 0.11, True),  # the other side strains less
        (0.05, 0.0, 0.08, False),  # alike: strain decides
        (0.05, 0.0, 0.051, True),
        (0.16, 0.0, np.nan, False),  # no rival came close
    ],
)
def test_a_side_that_is_hardly_likelier_is_told(strain, facing, rival, told):
    start = Start(np.empty(0, dtype=np.int64), np.eye(3), np.zeros(3))
    ways = [Side(-3.5, start, strain, facing), Side(-3.5, start, rival, -facing)]
    monitor = Monitor()
    matches._warn([], [], ways, [Side(-3.0, start, 0.2)], monitor)
    assert ("match_sides" in [each.kind for each in monitor.warnings]) == told
