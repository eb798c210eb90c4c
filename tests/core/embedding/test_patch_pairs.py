"""The pairs of equation 10."""

import numpy as np
import pytest

from addon.core.distances.spectral import GreensFunction
from addon.core.embedding import patch_pairs as module
from addon.core.embedding.patch_pairs import landmark_pairs, patch_pairs
from addon.core.patching.cells import Patch
from addon.core.run.monitor import Monitor
from addon.core.stress.pairs import AllPairs
from addon.core.surface.laplacian import mass, stiffness
from tests.meshes import shapes
from tests.meshes.shapes import prepared


def test_landmarks_weigh_their_share_of_what_the_patches_weigh():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(300, 3))
    weights = rng.uniform(0, 1, (200, 200)) * (1 - np.eye(200))
    patches = [AllPairs(each, np.ones((200, 200)), weights, 300) for each in (np.arange(200), np.arange(100, 300))]
    landmarks = np.array([3, 250, 150, 120])
    pairs = landmark_pairs(landmarks, points, patches, 0.7)
    held = np.zeros(300)
    for patch in patches:
        held[patch.chosen] += patch.weights.sum(axis=1)
    assert pairs.weights.sum() == pytest.approx(0.7 * held[landmarks].sum())
    np.testing.assert_allclose(pairs.distances, np.linalg.norm(points[landmarks][:, None] - points[landmarks], axis=2))
    assert np.ptp(pairs.weights[np.triu_indices(4, 1)]) == 0


def test_one_landmark_alone_weighs_nothing():
    patch = AllPairs(np.arange(3), np.ones((3, 3)), np.ones((3, 3)), 3)
    assert landmark_pairs(np.array([1]), np.zeros((3, 3)), [patch], 0.5).weights.tolist() == [[0.0]]


def test_weights_are_commute_times_over_distances_squared(figure):
    points, surface = prepared(*figure)
    whole = Patch(figure[1], np.arange(len(points)))
    green = GreensFunction(stiffness(surface), mass(surface))
    (pairs,) = patch_pairs(points, [whole], green.commute_time_squared, 0.1, Monitor())
    np.testing.assert_array_equal(pairs.distances, pairs.distances.T)
    apart = pairs.distances + np.eye(len(points))
    np.testing.assert_allclose(pairs.weights, green.commute_time_squared(whole.vertices) / apart**2, rtol=1e-12)


@pytest.mark.parametrize(("distance", "failed"), [(0.0, True), (0.9e-6, True), (1.1e-6, False)])
def test_a_pair_whose_distance_failed_gets_a_thousandth_of_the_mean_and_it_is_told(monkeypatch, distance, failed):
    """One pair has less than a millionth of the mean distance, which is 1."""
    points, faces = shapes.grid(2, 2, 1.0, 1.0)
    given = np.where(np.eye(4, dtype=bool), 0.0, 4 / 3)
    given[0, 1] = given[1, 0] = distance
    given[2, 3] = given[3, 2] = 8 / 3 - distance
    monkeypatch.setattr(module, "geodesics", lambda *_, **options: given.copy())
    monitor = Monitor()
    (pairs,) = patch_pairs(points, [Patch(faces, np.arange(4))], lambda vertices: np.ones((4, 4)), None, monitor)
    expected = 1e-3 if failed else distance
    assert pairs.distances[0, 1] == pytest.approx(expected)
    assert pairs.weights[0, 1] == pytest.approx(1 / expected**2)
    assert [(each.kind, each.numbers) for each in monitor.warnings] == [("zero_distances", {"count": 1})] * failed
