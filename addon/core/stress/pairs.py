"""Pairs of points, their weights, and what they want: a length, a direction, a vector."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ..numerics.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

Wants = Callable[[FloatArray, FloatArray], FloatArray]  # (pairs' vectors (e, 3), points (n, 3)) to the vectors wanted
_LEAST = 1e-12  # length below which a vector has no direction


class Term(Protocol):
    """A sum ``Σ w |d - t|²`` over pairs that a majorisation step can lower."""

    def laplacian(self) -> csr_matrix:
        """Assemble V: ``-w_ij`` off the diagonal, rows summing to 0."""

    def pull(self, points: FloatArray) -> FloatArray:
        """Sum ``w t`` at both ends of each pair: ``B(X) X`` where lengths are wanted."""

    def stress(self, points: FloatArray) -> float:
        """Sum ``w |d - t|²``."""


class Pairs:
    """A list of pairs of points.

    `ends` (e, 2); `weight` (e,); `count`: number of points n.

    Examples
    --------
    >>> pairs = Pairs(np.array([[0, 1], [1, 2]]), np.array([1.0, 2.0]), 3)
    >>> pairs.apart(np.array([[0.0], [1.0], [5.0]])).ravel().tolist()
    [-1.0, -4.0]
    >>> pairs.laplacian().toarray().tolist()
    [[1.0, -1.0, 0.0], [-1.0, 3.0, -2.0], [0.0, -2.0, 2.0]]
    """

    def __init__(self, ends: IntArray, weight: FloatArray, count: int) -> None:
        from scipy.sparse import csr_matrix

        self.ends, self.weight = ends, weight
        signs, start = np.tile([1.0, -1.0], len(ends)), 2 * np.arange(len(ends) + 1)
        self._differences = csr_matrix((signs, ends.ravel(), start), shape=(len(ends), count))
        self._to_ends = self._differences.T.tocsr()
        self._sums = abs(self._to_ends)

    def apart(self, points: FloatArray) -> FloatArray:
        """Compute ``d = x_i - x_j`` of each pair."""
        return np.asarray(self._differences @ points)

    def pulled(self, vectors: FloatArray) -> FloatArray:
        """Sum ``w`` times a vector of each pair at its first end, and minus that at its second."""
        return np.asarray(self._to_ends @ (self.weight[:, None] * vectors))

    def summed(self, values: FloatArray) -> FloatArray:
        """Sum ``w`` times values of the pairs that each point is in."""
        return np.asarray(self._sums @ (self.weight[:, None] * values))

    def mean(self, values: FloatArray) -> FloatArray:
        """Compute the mean of the values at the two ends of each pair."""
        return (values[self.ends[:, 0]] + values[self.ends[:, 1]]) / 2

    def laplacian(self) -> csr_matrix:
        """Assemble V: ``-w_ij`` off the diagonal, rows summing to 0."""
        from scipy.sparse import diags

        return self._to_ends @ diags(self.weight) @ self._differences

    def wanting(self, wants: Wants) -> WantedPairs:
        """Say what the pairs want."""
        return WantedPairs(self, wants)

    def wanting_lengths(self, lengths: FloatArray) -> WantedPairs:
        """Let each pair want a length, in the direction that it has: the stress of scaling."""
        return WantedPairs(self, lambda apart, _: apart * (lengths / length(apart))[:, None])


class WantedPairs(NamedTuple):
    """Pairs, and the vector t that each wants."""

    pairs: Pairs
    wants: Wants

    def laplacian(self) -> csr_matrix:
        """Assemble V."""
        return self.pairs.laplacian()

    def pull(self, points: FloatArray) -> FloatArray:
        """Sum ``w t`` at the ends."""
        return self.pairs.pulled(self.wants(self.pairs.apart(points), points))

    def stress(self, points: FloatArray) -> float:
        """Sum ``w |d - t|²``."""
        apart = self.pairs.apart(points)
        missing = self.wants(apart, points) - apart
        return float(np.einsum("e,ei,ei->", self.pairs.weight, missing, missing))


class AllPairs:
    """All pairs of some points, as matrices: each wants a distance, ``Σ_{i<j} w_ij (δ_ij - d_ij)²``.

    `chosen` (p,); `distances` (p, p); `weights` (p, p); `count`: number of points n of which they are some.

    Examples
    --------
    >>> line = np.array([[0.0], [1.0], [3.0]])
    >>> pairs = AllPairs(np.arange(3), np.abs(line - line.T), np.ones((3, 3)), 3)
    >>> pairs.stress(2 * line)
    14.0
    """

    def __init__(self, chosen: IntArray, distances: FloatArray, weights: FloatArray, count: int) -> None:
        self.chosen, self.distances, self.weights = chosen, distances, weights
        self._count = count

    def laplacian(self) -> csr_matrix:
        """Assemble V: ``-w_ij`` off the diagonal, rows summing to 0."""
        from scipy.sparse import coo_matrix

        block = -self.weights
        np.fill_diagonal(block, 0.0)
        np.fill_diagonal(block, -block.sum(axis=1))
        rows, columns = (np.broadcast_to(each, block.shape).ravel() for each in (self.chosen[:, None], self.chosen))
        return coo_matrix((block.ravel(), (rows, columns)), shape=(self._count, self._count)).tocsr()

    def pull(self, points: FloatArray) -> FloatArray:
        """Compute ``B(X) X``."""
        here, straight = self._apart(points)
        np.maximum(straight, _LEAST, out=straight)
        ratio = np.divide(self.distances, straight, out=straight)
        ratio *= self.weights
        np.fill_diagonal(ratio, 0.0)
        pulled = np.zeros_like(points)
        pulled[self.chosen] = ratio.sum(axis=1)[:, None] * here - ratio @ here
        return pulled

    def stress(self, points: FloatArray) -> float:
        """Sum ``w (δ - d)²`` over the pairs."""
        missing = self.distances - self._apart(points)[1]
        np.fill_diagonal(missing, 0.0)
        return float(np.einsum("ij,ij,ij->", self.weights, missing, missing)) / 2

    def _apart(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Measure the chosen points, centred, and the distances between them."""
        from scipy.spatial.distance import cdist

        here = points[self.chosen]
        here = here - here.mean(axis=0)  # near pairs lose nothing to the distance from the origin
        return here, cdist(here, here)


def length(vectors: FloatArray) -> FloatArray:
    """Measure vectors, (e,); never 0, so that they can be divided by it."""
    return np.maximum(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)), _LEAST)
