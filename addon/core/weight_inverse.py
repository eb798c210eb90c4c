"""V⁺, the pseudo-inverse of the weight Laplacian that a SMACOF step needs, factored once (paper section 3.4)."""

from __future__ import annotations

import numpy as np

from .monitor import Monitor
from .stress import CrossPairs, PairSet
from .surface import FloatArray, IntArray

_BLOCK = 256


class WeightInverse:
    """V⁺, the pseudo-inverse of the weight Laplacian, by block elimination.

    V is dense inside each pair set and empty between them. Vertices of one set only are eliminated set by set; what
    remains is a small system on the shared ones: feature points and the bands between closed patches.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    pair_sets : list of PairSet
        The sets; together they must connect all vertices.
    monitor : Monitor, optional
        Asked between blocks whether to stop.
    """

    def __init__(self, vertex_count: int, pair_sets: list[PairSet], monitor: Monitor | None = None) -> None:
        monitor = monitor or Monitor()
        uses = np.zeros(vertex_count, dtype=np.int64)
        for pairs in pair_sets:
            uses[pairs.vertices] += 1
        shared = uses > 1
        if not shared.any():
            shared[0] = True
        self._shared = np.flatnonzero(shared)
        position = np.full(vertex_count, -1, dtype=np.int64)
        position[self._shared] = np.arange(len(self._shared))
        remaining = np.zeros((len(self._shared), len(self._shared)))
        scale = 0.0
        self._blocks: list[tuple[IntArray, IntArray, FloatArray, FloatArray]] = []
        for done, pairs in enumerate(pair_sets):
            matrix = pairs.laplacian(monitor)
            border = np.flatnonzero(shared[pairs.vertices])
            inner = np.flatnonzero(~shared[pairs.vertices])
            place = position[pairs.vertices[border]]
            remaining[np.ix_(place, place)] += matrix[np.ix_(border, border)]
            scale = max(scale, float(np.diag(matrix).max()))
            if len(inner):
                coupling = matrix[np.ix_(inner, border)]
                factor = _cholesky(_submatrix(matrix, inner, monitor), monitor)
                half = _solve_lower(factor, coupling)
                remaining[np.ix_(place, place)] -= half.T @ half
                self._blocks.append((pairs.vertices[inner], place, factor, half))
            monitor.tick((done + 1) / len(pair_sets))
        # what remains has constants as its null space; adding them makes it regular and leaves the rest alone
        remaining += scale / len(remaining)
        self._remaining = _cholesky(remaining, monitor)

    def __call__(self, right: FloatArray) -> FloatArray:
        """Solve ``V Y = R`` for R whose columns sum to 0.

        Parameters
        ----------
        right : (n, d) ndarray of float
            R.

        Returns
        -------
        (n, d) ndarray of float
            Y = V⁺ R, columns centred.
        """
        shared = right[self._shared].copy()
        halves = []
        for inner, place, factor, half in self._blocks:
            halves.append(_solve_lower(factor, right[inner]))
            shared[place] -= half.T @ halves[-1]
        solved = np.empty_like(right)
        at_shared = _solve_lower(self._remaining, _solve_lower(self._remaining, shared), transposed=True)
        solved[self._shared] = at_shared
        for (inner, place, factor, half), forward in zip(self._blocks, halves, strict=True):
            solved[inner] = _solve_lower(factor, forward - half @ at_shared[place], transposed=True)
        return solved - solved.mean(axis=0)


class SampledWeightInverse:
    """V⁺ where only some vertices, the samples, are paired with all others.

    The others are paired with samples only, so they are eliminated by a division; what remains is a dense system on
    the samples.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    cross : list of CrossPairs
        The samples of each patch with all its vertices; together they must reach every vertex.
    pair_sets : list of PairSet
        Pairs among samples.
    monitor : Monitor, optional
        Asked between blocks whether to stop.
    """

    def __init__(
        self, vertex_count: int, cross: list[CrossPairs], pair_sets: list[PairSet], monitor: Monitor | None = None
    ) -> None:
        from scipy.sparse import csr_matrix

        monitor = monitor or Monitor()
        some = [pairs.rows for pairs in cross] + [pairs.vertices for pairs in pair_sets]
        self._samples = np.unique(np.concatenate(some))
        count = len(self._samples)
        position = np.full(vertex_count, -1, dtype=np.int64)
        position[self._samples] = np.arange(count)
        self._others = np.flatnonzero(position < 0)
        total = np.zeros(vertex_count)
        weights = np.zeros((count, vertex_count))
        for pairs in cross:
            monitor.check()
            total[pairs.rows] += pairs.weights.sum(axis=1)
            total[pairs.columns] += pairs.weights.sum(axis=0)
            weights[np.ix_(position[pairs.rows], pairs.columns)] += pairs.weights
        among = weights[:, self._samples]
        matrix = np.diag(total[self._samples]) - among - among.T
        for each in pair_sets:
            place = position[each.vertices]
            matrix[np.ix_(place, place)] += each.laplacian(monitor)
        share = weights[:, self._others] / total[self._others]  # (s, n - s)
        self._total = total[self._others]
        monitor.check()
        matrix -= share @ weights[:, self._others].T
        self._share = csr_matrix(share)  # a sample has weights in its own patches only
        matrix += float(np.diag(matrix).max()) / count  # constants are the null space
        self._factor = _cholesky(matrix, monitor)

    def __call__(self, right: FloatArray) -> FloatArray:
        """Solve ``V Y = R`` for R whose columns sum to 0.

        Parameters
        ----------
        right : (n, d) ndarray of float
            R.

        Returns
        -------
        (n, d) ndarray of float
            Y = V⁺ R, columns centred.
        """
        reduced = right[self._samples] + self._share @ right[self._others]
        at_samples = _solve_lower(self._factor, _solve_lower(self._factor, reduced), transposed=True)
        solved = np.empty_like(right)
        solved[self._samples] = at_samples
        solved[self._others] = right[self._others] / self._total[:, None] + self._share.T @ at_samples
        return solved - solved.mean(axis=0)


def _submatrix(matrix: FloatArray, chosen: IntArray, monitor: Monitor) -> FloatArray:
    """Copy the chosen rows and columns, a few rows at a time so that a cancel is heard."""
    part = np.empty((len(chosen), len(chosen)))
    for start in range(0, len(chosen), _BLOCK):
        monitor.check()
        rows = chosen[start : start + _BLOCK]
        np.take(matrix[rows], chosen, axis=1, out=part[start : start + _BLOCK])
    return part


def _cholesky(matrix: FloatArray, monitor: Monitor) -> FloatArray:
    """Factor in place, block by block so that a cancel is heard; what lies above the diagonal is not meaningful."""
    for start in range(0, len(matrix), _BLOCK):
        monitor.check()
        stop = start + _BLOCK
        if start:
            matrix[start:, start:stop] -= matrix[start:, :start] @ matrix[start:stop, :start].T
        corner = np.linalg.cholesky(matrix[start:stop, start:stop])
        matrix[start:stop, start:stop] = corner
        if stop < len(matrix):
            matrix[stop:, start:stop] = _solve_lower(corner, matrix[stop:, start:stop].T).T
    return matrix


def _solve_lower(factor: FloatArray, right: FloatArray, transposed: bool = False) -> FloatArray:
    from scipy.linalg import solve_triangular

    return solve_triangular(factor, right, lower=True, trans=int(transposed), check_finite=False)
