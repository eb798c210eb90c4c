"""Factors of sparse matrices and of nearly full ones."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix, diags

from addon.core.numerics.factoring import factored
from addon.core.run.errors import SolverError


@pytest.mark.parametrize("near", [1, 40])
def test_sparse_and_nearly_full_matrices_are_solved_alike(near: int):
    rng = np.random.default_rng(near)
    rows = np.arange(60)
    matrix = np.where(np.abs(rows[:, None] - rows) <= near, rng.uniform(0, 1, (60, 60)), 0.0)
    matrix = matrix + matrix.T + 200 * np.eye(60)
    right = rng.normal(size=(60, 3))
    factor = factored(csr_matrix(matrix))
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(matrix, right), atol=1e-14)
    np.testing.assert_allclose(factor.solve(right[:, 0]), factor.solve(right)[:, 0], atol=1e-15)


@pytest.mark.parametrize("matrix", [np.zeros((3, 3)), diags([1.0] + [0.0] * 99)])
def test_a_singular_matrix_is_refused(matrix):
    with pytest.raises(SolverError):
        factored(matrix)
