"""Products in small blocks are products."""

import numpy as np
import pytest

from addon.core.numerics.products import product


@pytest.mark.parametrize(
    "shape", [(3, 4, 5), (500, 700, 3), (130, 900, 70), (64, 64, 64), (1, 300_000, 1), (0, 4, 2), (5, 0, 3)]
)
def test_blocks_give_the_product(shape):
    rng = np.random.default_rng(0)
    left, right = rng.normal(size=shape[:2]), rng.normal(size=shape[1:])
    np.testing.assert_allclose(product(left, right), left @ right, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(product(right.T, left.T), (left @ right).T, rtol=1e-10, atol=1e-10)
