"""Products in small blocks are products."""

import numpy as np
import pytest

from addon.core.numerics.products import inverse_of_lower, product


@pytest.mark.parametrize(
    "shape", [(3, 4, 5), (500, 700, 3), (130, 900, 70), (64, 64, 64), (1, 300_000, 1), (0, 4, 2), (5, 0, 3)]
)
def test_blocks_give_the_product(shape):
    rng = np.random.default_rng(0)
    left, right = rng.normal(size=shape[:2]), rng.normal(size=shape[1:])
    np.testing.assert_allclose(product(left, right), left @ right, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(product(right.T, left.T), (left @ right).T, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("count", [1, 2, 13, 64])
def test_the_inverse_of_a_lower_triangle(count):
    lower = np.linalg.cholesky(np.cov(np.random.default_rng(1).normal(size=(count, 3 * count))) + np.eye(count))
    found = inverse_of_lower(lower)
    np.testing.assert_allclose(found @ lower, np.eye(count), atol=1e-12)
    assert not np.triu(found, 1).any()
