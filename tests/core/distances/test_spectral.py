import numpy as np
import pytest
from scipy.linalg import eigh

from addon.core.distances.spectral import GreensFunction, biharmonic_squared, commute_time_squared
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
