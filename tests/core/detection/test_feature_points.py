import numpy as np

from addon.core.detection.feature_points import merged, prominent_maxima
from tests.meshes import shapes


def brute_prominence(values, faces):
    """Prominence of every maximum by flooding: the highest level at which it is joined to a higher vertex."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    logs = np.log(values)
    row, column = faces.ravel(), np.roll(faces, 1, axis=1).ravel()
    found = {}
    for vertex in range(len(values)):
        around = np.unique(faces[(faces == vertex).any(axis=1)])
        if values[vertex] < values[around].max():
            continue
        found[vertex] = np.ptp(logs)
        for level in np.sort(logs)[::-1]:
            above = (logs[row] >= level) & (logs[column] >= level)
            graph = coo_matrix((np.ones(above.sum()), (row[above], column[above])), shape=(len(values),) * 2)
            part = connected_components(graph, directed=False)[1]
            if (logs[part == part[vertex]] > logs[vertex]).any():
                found[vertex] = logs[vertex] - level
                break
    return found


def test_prominence_equals_flooding_on_a_rough_field():
    vertices, faces = shapes.grid(14, 11)
    values = np.exp(np.random.default_rng(2).normal(size=len(vertices)))
    maxima, prominence = prominent_maxima(values, faces, 0.0)
    expected = brute_prominence(values, faces)
    assert set(maxima) == set(expected)
    np.testing.assert_allclose(prominence, [expected[vertex] for vertex in maxima])
    assert (np.diff(prominence) <= 0).all()


def test_threshold_keeps_the_prominent_ones_and_always_one():
    vertices, faces = shapes.grid(60, 20, 3.0, 1.0)
    bumps = [(0.5, 0.5, 8.0), (1.5, 0.5, 4.0), (2.5, 0.5, 0.3)]
    values = 1 + sum(h * np.exp(-((vertices[:, 0] - x) ** 2 + (vertices[:, 1] - y) ** 2) / 0.02) for x, y, h in bumps)
    maxima, _ = prominent_maxima(values, faces, 0.5)
    np.testing.assert_allclose(vertices[maxima, 0], [0.5, 1.5], atol=0.06)
    assert len(prominent_maxima(values, faces, 99.0)[0]) == 1
    assert len(prominent_maxima(np.ones(len(vertices)), faces, 0.5)[0]) == 1


def test_rounding_does_not_change_the_order_of_equal_maxima():
    vertices, faces = shapes.grid(41, 21, 2.0, 1.0)
    values = 1 + sum(np.exp(-((vertices[:, 0] - x) ** 2 + (vertices[:, 1] - 0.5) ** 2) / 0.02) for x in (0.5, 1.5))
    noise = np.random.default_rng(0).normal(size=(5, len(values)))
    orders = {tuple(prominent_maxima(values * (1 + 1e-13 * each), faces)[0]) for each in noise}
    assert len(orders) == 1
    one, two = orders.pop()
    assert one < two  # of equal ones the first counts as the higher


def test_a_prominence_of_just_the_threshold_is_kept():
    vertices, faces = shapes.grid(7, 2)
    values = np.exp(np.array([3.0, 1.0, 2.0, 1.0, 1.5, 1.0, 1.2])[(6 * vertices[:, 0]).round().astype(int)])
    assert len(prominent_maxima(values, faces, prominent_maxima(values, faces, 0.0)[1][2])[0]) == 3


def test_close_points_become_the_most_prominent_one():
    places = np.array([0.0, 0.1, 1.0, 1.04, 2.0])
    apart = np.abs(places[:, None] - places)
    np.testing.assert_array_equal(merged(np.arange(5), apart, 0.2), [0, 2, 4])
    np.testing.assert_array_equal(merged(np.arange(5), apart, 0.1), [0, 1, 2, 4])  # just so far is far enough
