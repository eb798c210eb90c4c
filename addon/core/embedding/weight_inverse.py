"""V⁺, the pseudo-inverse of the weight Laplacian that a SMACOF step needs, factored once (paper section 3.4)."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..numerics.products import inverse_of_lower, product
from ..run.monitor import Monitor
from .stress import PairSet

_BLOCK = 48


class WeightInverse:
    """V⁺, the pseudo-inverse of the weight Laplacian, by block elimination.

    V is dense inside each pair set and empty between them. Vertices of one set only are eliminated set by set, those
    that are no sources first: among them V is nearly diagonal. What remains is a small system on the shared ones:
    feature points, landmarks and the bands between closed patches.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    pair_sets : list of PairSet
        The sets; together they must connect all vertices.
    monitor : Monitor, optional
        Polled for cancellation between blocks.

    Examples
    --------
    >>> from addon.core.embedding.stress import pair_set
    >>> pairs = pair_set(np.arange(3), np.ones((3, 3)), lambda rows, columns, target: np.ones_like(target))
    >>> right = np.array([[1.0], [1.0], [-2.0]])
    >>> np.allclose(pairs.laplacian()[0] @ WeightInverse(3, [pairs])(right), right)
    True
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
        self._blocks: list[tuple[_Others, IntArray, IntArray, _Cholesky, FloatArray]] = []
        for done, pairs in enumerate(pair_sets):
            others = _Others(pairs, shared, monitor)
            matrix, vertices = others.remaining, others.kept
            scale = max(scale, float(np.diag(matrix).max()))
            border = np.flatnonzero(shared[vertices])
            inner = np.flatnonzero(~shared[vertices])
            place = position[vertices[border]]
            remaining[np.ix_(place, place)] += matrix[np.ix_(border, border)]
            factor = _Cholesky(_submatrix(matrix, inner, monitor), monitor)
            half = factor.forward(matrix[np.ix_(inner, border)], monitor)
            remaining[np.ix_(place, place)] -= product(half.T, half)
            self._blocks.append((others, vertices[inner], place, factor, half))
            monitor.tick((done + 1) / len(pair_sets))
        # what remains has constants as its null space; adding them makes it regular and leaves the rest alone
        remaining += scale / len(remaining)
        self._remaining = _Cholesky(remaining, monitor)

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
        right = right.copy()
        for others, *_ in self._blocks:
            others.pass_on(right)
        shared = right[self._shared]
        halves = []
        for _, inner, place, factor, half in self._blocks:
            halves.append(factor.forward(right[inner]))
            shared[place] -= product(half.T, halves[-1])
        at_shared = self._remaining.backward(self._remaining.forward(shared))
        solved = np.empty_like(right)
        solved[self._shared] = at_shared
        for (others, inner, place, factor, half), forward in zip(self._blocks, halves, strict=True):
            solved[inner] = factor.backward(forward - product(half, at_shared[place]))
            others.fill_in(solved, right)
        return np.asarray(solved - solved.mean(axis=0))


class _Others:
    """The vertices of one pair set only that are no sources, and what is left of its V when they are eliminated."""

    def __init__(self, pairs: PairSet, shared: np.ndarray, monitor: Monitor) -> None:
        of_sources, among_others = pairs.laplacian(monitor)
        count = len(of_sources)
        self._vertices, self.kept, self.remaining = pairs.vertices[count:], pairs.vertices, of_sources
        if not len(self._vertices):
            return
        stay = shared[pairs.vertices[count:]]
        go, stay = np.flatnonzero(~stay), np.flatnonzero(stay)
        self._vertices = pairs.vertices[count + go]
        self.kept = np.concatenate([pairs.vertices[:count], pairs.vertices[count + stay]])
        across, columns = of_sources[:, count + stay], among_others[:, stay]
        self.remaining = np.block([[of_sources[:, :count], across], [across.T, columns[stay].toarray()]])
        if not len(go):
            return
        coupling = np.hstack([of_sources[:, count + go].T, columns[go].toarray()])
        monitor.check()
        self._solve = factored(among_others[go][:, go]).solve
        self._reached = self._solve(coupling)  # A⁻¹ C
        self.remaining -= product(coupling.T, self._reached)

    def pass_on(self, right: FloatArray) -> None:
        """Bring their right-hand side to the rest."""
        if not len(self._vertices):
            return
        right[self.kept] -= product(self._reached.T, right[self._vertices])

    def fill_in(self, solved: FloatArray, right: FloatArray) -> None:
        """Solve for them when the rest is known."""
        if not len(self._vertices):
            return
        solved[self._vertices] = self._solve(right[self._vertices]) - product(self._reached, solved[self.kept])


def _submatrix(matrix: FloatArray, chosen: IntArray, monitor: Monitor) -> FloatArray:
    """Copy the chosen rows and columns, a few rows at a time so that a cancellation is noticed."""
    part = np.empty((len(chosen), len(chosen)))
    for start in range(0, len(chosen), _BLOCK):
        monitor.check()
        rows = chosen[start : start + _BLOCK]
        np.take(matrix[rows], chosen, axis=1, out=part[start : start + _BLOCK])
    return part


class _Cholesky:
    """L with L Lᵀ = A, made in place of A; by blocks, so that a cancellation is noticed and no threads are woken.

    A triangular solve of a linear algebra library would run on all threads; this chain of small products does not.
    """

    def __init__(self, matrix: FloatArray, monitor: Monitor) -> None:
        self._lower = matrix
        self._corners: list[tuple[slice, FloatArray]] = []  # inverses of the diagonal blocks
        for start in range(0, len(matrix), _BLOCK):
            monitor.check()
            here, below = slice(start, start + _BLOCK), slice(start + _BLOCK, None)
            if start:
                matrix[start:, here] -= product(matrix[start:, :start], matrix[here, :start].T)
            corner = inverse_of_lower(np.linalg.cholesky(matrix[here, here]))
            matrix[below, here] = product(matrix[below, here], corner.T)
            self._corners.append((here, corner))

    def forward(self, right: FloatArray, monitor: Monitor | None = None) -> FloatArray:
        """Solve L Y = R."""
        solved = np.empty_like(right)
        for here, corner in self._corners:
            if monitor is not None:
                monitor.check()
            known = product(self._lower[here, : here.start], solved[: here.start])
            solved[here] = product(corner, right[here] - known)
        return solved

    def backward(self, right: FloatArray) -> FloatArray:
        """Solve Lᵀ Y = R."""
        solved = right.copy()
        for here, corner in reversed(self._corners):
            solved[here] = product(corner.T, solved[here])
            solved[: here.start] -= product(self._lower[here, : here.start].T, solved[here])
        return solved
