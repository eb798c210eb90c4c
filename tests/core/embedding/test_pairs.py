"""The pairs between the patches."""

from dataclasses import replace

import numpy as np
import pytest

from addon.core.distances.spectral import GreensFunction
from addon.core.embedding import pairs as module
from addon.core.embedding.pairs import arrangement_pairs, balanced, patch_pairs
from addon.core.embedding.stress import PairList, Stress, pair_set
from addon.core.embedding.weight_inverse import WeightInverse
from addon.core.patching.cells import Patch
from addon.core.run.monitor import Monitor
from addon.core.surface.laplacian import mass, stiffness
from tests.meshes import shapes
from tests.meshes.shapes import prepared


def test_the_arrangement_weighs_its_share_of_what_the_patches_weigh():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(300, 3))
    weights = rng.uniform(0, 1, (200, 200))
    patches = [
        pair_set(members, np.ones((200, 200)), lambda rows, columns, _: weights[rows, columns])
        for members in (np.arange(200), np.arange(100, 300))
    ]
    landmarks = np.array([3, 250, 150, 120])
    pairs = balanced(arrangement_pairs(landmarks, points), patches, 300, 0.7)
    held = np.zeros(300)
    for patch in patches:
        held[patch.vertices] += patch.total_weights()
    assert pairs.total_weights().sum() == pytest.approx(0.7 * held[landmarks].sum())
    apart = np.linalg.norm(points[landmarks][:, None] - points[landmarks], axis=2)
    np.testing.assert_allclose(np.triu(pairs.targets[0]), np.triu(apart))
    assert np.ptp(pairs.weights[0][np.triu_indices(4, 1)]) == 0


def test_an_arrangement_of_one_landmark_has_no_weight_to_scale():
    patch = pair_set(np.arange(3), np.ones((3, 3)), lambda rows, columns, target: np.ones_like(target))
    nothing = arrangement_pairs(np.array([1]), np.zeros((3, 3)))
    assert balanced(nothing, [patch], 3, 0.5) is nothing


def tiles_of(weights):
    return lambda rows, columns, _: weights[rows, columns]


@pytest.fixture
def sparse_sets():
    """Two overlapping sets with few sources and some single pairs over 300 points, and V of each, dense."""
    rng = np.random.default_rng(2)
    made, dense = [], []
    for members, sources in ((rng.permutation(200), 30), (np.arange(150, 300)[::-1], 20)):
        count = len(members)
        wanted, heavy = rng.uniform(0.2, 2, (2, sources, count))
        pairs = pair_set(members, wanted, tiles_of(heavy))
        one, two = rng.choice(count, (2, 40))
        kept = one != two
        further = PairList(np.column_stack([one, two])[kept], *rng.uniform(0.2, 2, (2, kept.sum())))
        made.append(replace(pairs, further=further))
        weights = np.zeros((count, count))
        weights[:sources] = np.triu(heavy, 1)
        np.add.at(weights, tuple(further.pairs.T), further.weights)
        dense.append(np.diag((weights + weights.T).sum(axis=1)) - weights - weights.T)
    return made, dense


def assembled(pairs):
    """V from its two parts."""
    of_sources, among_others = pairs.laplacian()
    return np.block([[of_sources], [of_sources[:, pairs.source_count :].T, among_others.toarray()]])


def test_pairs_of_sources_and_single_ones_make_up_the_laplacian(sparse_sets):
    for pairs, dense in zip(*sparse_sets, strict=True):
        np.testing.assert_allclose(assembled(pairs), dense, atol=1e-12)
        np.testing.assert_allclose(pairs.total_weights(), np.diag(dense), atol=1e-12)
        np.testing.assert_allclose(assembled(pairs.scaled(3.0)), 3 * dense, atol=1e-11)
        sources, count = pairs.source_count, len(pairs.vertices)
        assert pairs.pair_count == count**2 - (count - sources) ** 2 + 2 * len(pairs.further.pairs)


def test_the_stress_sums_pairs_of_sources_and_single_ones(sparse_sets):
    points = np.random.default_rng(0).normal(size=(300, 3))
    expected = 0.0
    for pairs in sparse_sets[0]:
        own = points[pairs.vertices]
        for row, (wanted, heavy) in enumerate(zip(of_sources(pairs, 0), of_sources(pairs, 1), strict=True)):
            expected += (heavy * (wanted - np.linalg.norm(own[row] - own, axis=1)) ** 2)[row + 1 :].sum()
        (one, two), wanted, heavy = pairs.further.pairs.T, pairs.further.targets, pairs.further.weights
        expected += (heavy * (wanted - np.linalg.norm(own[one] - own[two], axis=1)) ** 2).sum()
    stress = Stress(300, sparse_sets[0])
    value, pull = stress.value_and_descent(points)
    assert value == pytest.approx(expected, rel=1e-12)
    direction = np.random.default_rng(1).normal(size=(300, 3))
    slope = (stress.value(points + 1e-5 * direction) - stress.value(points - 1e-5 * direction)) / 2e-5
    assert -2 * np.vdot(pull, direction) == pytest.approx(slope, rel=1e-6)


def of_sources(pairs, part):
    """Undo the tiles: targets (0) or weights (1), row by row."""
    return [np.concatenate([np.zeros(start), row]) for start, *tile in pairs.tiles() for row in tile[part]]


def test_those_that_are_no_sources_are_eliminated_as_all_others(sparse_sets):
    made, dense = sparse_sets
    whole = np.zeros((300, 300))
    for pairs, own in zip(made, dense, strict=True):
        whole[np.ix_(pairs.vertices, pairs.vertices)] += own
    right = np.random.default_rng(1).normal(size=(300, 3))
    right -= right.mean(axis=0)
    before = right.copy()
    np.testing.assert_allclose(WeightInverse(300, made)(right), np.linalg.pinv(whole) @ right, atol=1e-10)
    np.testing.assert_array_equal(right, before)


def test_a_share_of_the_vertices_measures_the_patch(figure):
    points, surface = prepared(*figure)
    whole = Patch(figure[1], np.arange(len(points)))
    green = GreensFunction(stiffness(surface), mass(surface))
    every, some = (
        patch_pairs(points, [whole], green.commute_time_squared, heat_time=0.1, source_share=share, monitor=Monitor())[
            0
        ]
        for share in (1.0, 0.1)
    )
    count = len(points)
    assert every.source_count == count
    np.testing.assert_array_equal(every.vertices, np.arange(count))
    assert some.source_count == round(0.1 * count)
    assert sorted(some.vertices) == list(range(count))
    everything = np.vstack(of_sources(every, 0))
    everything = np.triu(everything, 1) + np.triu(everything, 1).T
    expected = everything[np.ix_(some.vertices[: some.source_count], some.vertices)]
    found = np.vstack(of_sources(some, 0))
    upper = np.triu(np.ones_like(found, dtype=bool), 1) & (found > 0)
    assert upper.sum() > 0.999 * np.triu(np.ones_like(found), 1).sum()
    off = np.abs(found - expected)[upper]
    assert off.mean() < 0.03 * expected.mean()  # the mean of both ways, and one way
    between = np.triu(np.ones((some.source_count,) * 2, dtype=bool), 1)
    np.testing.assert_allclose(found[:, : some.source_count][between], expected[:, : some.source_count][between])
    nearest = everything[some.vertices[: some.source_count]].min(axis=0)
    assert nearest.max() < 4 * np.median(nearest[nearest > 0])  # sources lie everywhere


@pytest.mark.parametrize("side", [5, 9])
def test_a_small_patch_has_some_sources(side):
    points, faces = shapes.grid(side, side, 1.0, 1.0)
    whole = Patch(faces, np.arange(len(points)))
    (pairs,) = patch_pairs(
        points, [whole], lambda vertices: 1.0 - np.eye(len(vertices)), source_share=0.01, monitor=Monitor()
    )
    assert pairs.source_count == min(40, len(points))


@pytest.mark.parametrize(("distance", "failed"), [(0.0, True), (0.9e-6, True), (1.1e-6, False)])
def test_a_pair_whose_distance_failed_gets_a_thousandth_of_the_mean_and_it_is_told(monkeypatch, distance, failed):
    """One pair has less than a millionth of the mean distance, which is 1."""
    points, faces = shapes.grid(2, 2, 1.0, 1.0)
    given = np.where(np.eye(4, dtype=bool), 0.0, 4 / 3)
    given[0, 1] = given[1, 0] = distance
    given[2, 3] = given[3, 2] = 8 / 3 - distance
    monkeypatch.setattr(module, "geodesics", lambda *_, **options: given.copy())
    monitor = Monitor()
    (pairs,) = patch_pairs(points, [Patch(faces, np.arange(4))], lambda vertices: np.ones((4, 4)), monitor=monitor)
    expected = 1e-3 if failed else distance
    assert pairs.targets[0][0, 1] == pytest.approx(expected)
    assert pairs.weights[0][0, 1] == pytest.approx(1 / expected**2)
    assert [(each.kind, each.numbers) for each in monitor.warnings] == [("zero_distances", {"count": 1})] * failed
