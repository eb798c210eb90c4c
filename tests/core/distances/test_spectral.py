import numpy as np
import pytest
from scipy.linalg import eigh

from addon.core import CancelledError
from addon.core.distances.geodesics import all_geodesics
from addon.core.distances.spectral import GreensFunction, biharmonic_squared, commute_time_squared
from addon.core.run.monitor import Monitor
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


@pytest.fixture(scope="module")
def small():
    vertices, faces = shapes.sphere(2)
    vertices = vertices * [1.0, 1.7, 0.6]
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    L, M = stiffness(surface), mass(surface)
    values, vectors = eigh(L.toarray(), np.diag(M))
    return L, M, values[1:], vectors[:, 1:]


def dense(values, vectors, power, one, two):
    return sum((vectors[one, k] - vectors[two, k]) ** 2 / values[k] ** power for k in range(len(values)))


def test_commute_time_and_biharmonic_distance_against_a_dense_eigendecomposition(small):
    L, M, values, vectors = small
    spectrum = compute_spectrum(L, M, len(values))
    points = np.array([0, 5, 17, 99, 160])
    c2 = commute_time_squared(spectrum, points, points)
    b2 = biharmonic_squared(spectrum, points, points)
    green = GreensFunction(L, M)
    exact, exact_c2 = green.biharmonic_distances(points), green.commute_time_squared(points)
    for i, one in enumerate(points):
        for j, two in enumerate(points):
            assert c2[i, j] == pytest.approx(dense(values, vectors, 1, one, two), rel=1e-8, abs=1e-12)
            assert exact_c2[i, j] == pytest.approx(dense(values, vectors, 1, one, two), rel=1e-8, abs=1e-12)
            assert b2[i, j] == pytest.approx(dense(values, vectors, 2, one, two), rel=1e-8, abs=1e-12)
            assert exact[i, j] == pytest.approx(np.sqrt(dense(values, vectors, 2, one, two)), rel=1e-8, abs=1e-10)


def test_commute_times_of_many_points_are_those_of_the_pseudo_inverse():
    surface = intrinsic_delaunay(triangulated(*shapes.sphere(3)))
    L, M = stiffness(surface), mass(surface)
    points = np.random.default_rng(0).permutation(surface.vertex_count)[:300]
    inverse = np.linalg.pinv(L.toarray())[np.ix_(points, points)]
    diagonal = np.diag(inverse)
    expected = diagonal[:, None] + diagonal - 2 * inverse
    found = GreensFunction(L, M).commute_time_squared(points)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-10)
    np.testing.assert_array_equal(found, found.T)


def test_all_geodesics_of_a_plane_are_euclidean():
    vertices, faces = shapes.grid(19, 15, 1.8, 1.4)
    true = np.linalg.norm(vertices[:, None] - vertices, axis=2)
    off = np.abs(all_geodesics(triangulated(vertices, faces)) - true)
    assert off.mean() < 0.02 * true.mean()


def test_truncated_sums_run_over_the_pairs_at_hand(small):
    L, M, values, vectors = small
    c2 = commute_time_squared(compute_spectrum(L, M, 8), np.array([3]), np.array([50, 80]))
    np.testing.assert_allclose(c2[0], [dense(values[:8], vectors, 1, 3, two) for two in (50, 80)], rtol=1e-8)


def test_biharmonic_distance_is_a_metric_and_a_length(small):
    L, M, *_ = small
    points = np.arange(0, 162, 9)
    d = GreensFunction(L, M).biharmonic_distances(points)
    assert (d[:, None, :] <= d[:, :, None] + d[None, :, :] + 1e-12).all()
    np.testing.assert_allclose(
        GreensFunction(L, 9 * M).biharmonic_distances(points), 3 * d, rtol=1e-9
    )  # the surface 3 times as large


def test_all_geodesics_are_symmetric_positive_and_nearly_a_metric(figure):
    vertices, faces = figure
    near = np.flatnonzero(vertices[:, 1] < -0.9)
    local = np.full(len(vertices), -1)
    local[near] = np.arange(len(near))
    inside = local[faces[(local[faces] >= 0).all(axis=1)]]
    used, inside = np.unique(inside, return_inverse=True)
    points = vertices[near[used]]
    d = all_geodesics(triangulated(points, inside.reshape(-1, 3)))
    np.testing.assert_array_equal(d, d.T)
    assert (np.diag(d) == 0).all()
    assert d[~np.eye(len(d), dtype=bool)].min() > 0
    straight = np.linalg.norm(points[:, None] - points, axis=2)
    assert (d > 0.85 * straight).mean() > 0.99
    some = np.arange(0, len(d), 7)
    part = d[np.ix_(some, some)]
    violation = part[:, None, :] - part[:, :, None] - part[None, :, :]
    assert violation.max() < 0.05 * d.max()


def test_smoothed_geodesics_are_plain_near_and_positive():
    vertices, faces = shapes.grid(41, 41, 1.0, 1.0)
    plain, smooth = (all_geodesics(triangulated(vertices, faces), smooth=time)[[0, 840]] for time in (None, 0.1))
    true = np.linalg.norm(vertices[[0, 840]][:, None] - vertices[None], axis=2)
    assert (np.abs(plain - true)[true > 0] / true[true > 0]).mean() < 0.03
    assert (smooth[true > 0] > 0).all()
    near = (true > 0) & (true < 0.05)
    assert (np.abs(smooth - true)[near] / true[near]).mean() < 0.15
    assert np.corrcoef(smooth.ravel(), true.ravel())[0, 1] > 0.97


def test_smoothed_geodesics_feel_a_bend_less():
    vertices, faces = shapes.cylinder(24, 81, 0.15, 3.0)
    x, y, z = vertices.T
    bent = np.column_stack([(x + 1) * np.cos(z), y, (x + 1) * np.sin(z)])  # a tube around a circle of radius 1
    change = []
    for time in (None, 0.4):
        one, two = (all_geodesics(triangulated(points, faces), smooth=time) for points in (vertices, bent))
        far = one > 1.0
        change.append(np.abs(two[far] / one[far] - 1).mean())
    assert change[1] < 0.7 * change[0]


def test_all_geodesics_hear_a_cancel(sphere):
    with pytest.raises(CancelledError):
        all_geodesics(triangulated(*sphere), monitor=Monitor(cancelled=lambda: True))


def test_all_geodesics_tell_how_far_they_are(sphere):
    told = []
    monitor = Monitor(lambda fraction, _: told.append(fraction))
    with monitor.stage("Distances"):
        all_geodesics(triangulated(*shapes.sphere(1)), monitor=monitor, done=0.25, share=0.5)
    assert told == pytest.approx([0.0, 0.25 + 0.5 * 32 / 42, 0.75, 1.0])
