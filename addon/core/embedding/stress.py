"""The stress of equation 10 as sums over sets of pairs: patches and feature points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

# Pairs in a tile, and rows at most: they fit the cache, a cancellation is noticed between them, and their products are
# small enough that a linear algebra library runs them on one thread; more would wait for each other longer than this
# takes.
_TILE = 64**3 // 5  # times 5 columns
_ROWS = 128


@dataclass(frozen=True, eq=False)
class PairSet:
    """All pairs among some vertices, each with a wanted distance and a weight, stored once, in tiles.

    A tile holds some rows and the columns from the first of them to the end; what lies on or below the diagonal has
    weight 0.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        The vertices.
    targets : list of (r, c) ndarray of float
        Wanted distances, tile by tile.
    weights : list of (r, c) ndarray of float
        Weights, tile by tile.
    """

    vertices: IntArray
    targets: list[FloatArray]
    weights: list[FloatArray]

    def total_weights(self) -> FloatArray:
        """Sum the weights of the pairs that each vertex is in.

        Returns
        -------
        (p,) ndarray of float
            Total weight by vertex: the diagonal of V.
        """
        total = np.zeros(len(self.vertices))
        for start, weight in zip(_tiles(len(total)), self.weights, strict=True):
            total[start : start + len(weight)] += weight.sum(axis=1)
            total[start:] += weight.sum(axis=0)
        return total

    def scaled(self, factor: float) -> PairSet:
        """Multiply all weights.

        Parameters
        ----------
        factor : float
            The factor.

        Returns
        -------
        PairSet
            The same pairs and targets under the new weights.
        """
        return PairSet(self.vertices, self.targets, [factor * weight for weight in self.weights])

    def replaced(
        self, pairs: IntArray, targets: FloatArray, weights: FloatArray, monitor: Monitor | None = None
    ) -> PairSet:
        """Replace the wanted distances and the weights of some pairs.

        Parameters
        ----------
        pairs : (s, 2) ndarray of int
            Pairs of positions in `vertices`, the smaller first.
        targets : (s,) ndarray of float
            Wanted distances.
        weights : (s,) ndarray of float
            Weights.
        monitor : Monitor, optional
            Polled for cancellation between tiles.

        Returns
        -------
        PairSet
            The pairs; tiles without a change are shared with this set.
        """
        tiles = _tiles(len(self.vertices))
        all_targets, all_weights = list(self.targets), list(self.weights)
        tile, row = np.divmod(pairs[:, 0], tiles.step)
        for index in np.unique(tile):
            if monitor is not None:
                monitor.check()
            here = tile == index
            at = row[here], pairs[here, 1] - tiles[index]
            all_targets[index], all_weights[index] = self.targets[index].copy(), self.weights[index].copy()
            all_targets[index][at], all_weights[index][at] = targets[here], weights[here]
        return PairSet(self.vertices, all_targets, all_weights)

    def laplacian(self, monitor: Monitor | None = None) -> FloatArray:
        """Assemble V of these pairs: ``-w_ij`` off the diagonal, row sums 0.

        Parameters
        ----------
        monitor : Monitor, optional
            Polled for cancellation between tiles.

        Returns
        -------
        (p, p) ndarray of float
            V, symmetric, positive semi-definite.
        """
        count = len(self.vertices)
        matrix = np.zeros((count, count))
        for start, weight in zip(_tiles(count), self.weights, strict=True):
            if monitor is not None:
                monitor.check()
            matrix[start : start + len(weight), start:] -= weight
            matrix[start:, start : start + len(weight)] -= weight.T
        np.fill_diagonal(matrix, self.total_weights())
        return matrix


def pair_set(
    vertices: IntArray, distances: FloatArray, weights: Callable[[slice, slice, FloatArray], FloatArray]
) -> PairSet:
    """Store all pairs among some vertices in tiles.

    Parameters
    ----------
    vertices : (p,) ndarray of int
        The vertices.
    distances : (p, p) ndarray of float
        Wanted distances; the part above the diagonal is read.
    weights : callable
        Gives the weights of a tile from its rows, its columns (slices of 0 to p) and its wanted distances.

    Returns
    -------
    PairSet
        The pairs.

    Examples
    --------
    >>> pairs = pair_set(np.arange(3), np.ones((3, 3)), lambda rows, columns, target: np.full_like(target, 2.0))
    >>> pairs.total_weights().tolist()
    [4.0, 4.0, 4.0]
    """
    targets, heavy = [], []
    tiles = _tiles(len(vertices))
    for start in tiles:
        rows, columns = slice(start, min(start + tiles.step, len(vertices))), slice(start, len(vertices))
        target = np.ascontiguousarray(distances[rows, columns])
        targets.append(target)
        heavy.append(np.triu(weights(rows, columns, target), 1))
    return PairSet(vertices, targets, heavy)


class Stress:
    """Equation 10: the weighted squared difference between wanted and embedded distances, over all pair sets.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    pair_sets : list of PairSet
        Patches and feature points.
    monitor : Monitor, optional
        Polled for cancellation between tiles.

    Examples
    --------
    >>> line = np.array([[0.0], [1.0], [3.0]])
    >>> pairs = pair_set(np.arange(3), np.abs(line - line.T), lambda rows, columns, target: np.ones_like(target))
    >>> stress = Stress(3, [pairs])
    >>> round(stress.value(line), 6), round(stress.value(2 * line), 6)
    (0.0, 14.0)
    """

    def __init__(self, vertex_count: int, pair_sets: list[PairSet], monitor: Monitor | None = None) -> None:
        self.vertex_count = vertex_count
        self.pair_sets = pair_sets
        self._monitor = monitor or Monitor()
        largest = max((_tiles(count).step * count for count in (len(pairs.vertices) for pairs in pair_sets)), default=0)
        # working memory of every tile in turn: fresh pages cost more than the sums
        self._room = np.empty((3, largest))

    def value(self, embedding: FloatArray) -> float:
        """Evaluate the stress.

        Parameters
        ----------
        embedding : (n, d) ndarray of float
            Point of every vertex.

        Returns
        -------
        float
            ``Σ w_ij (δ_ij - |x_i - x_j|)²``.
        """
        return self.value_and_descent(embedding)[0]

    def value_and_descent(self, embedding: FloatArray) -> tuple[float, FloatArray]:
        """Evaluate the stress and minus half its gradient.

        Parameters
        ----------
        embedding : (n, d) ndarray of float
            Point of every vertex.

        Returns
        -------
        value : float
            The stress.
        descent : (n, d) ndarray of float
            ``(B(X) - V) X``: the rows are ``Σ_j w_ij (δ_ij / d_ij - 1) (x_i - x_j)``.

        Raises
        ------
        CancelledError
            If the run is cancelled.
        """
        total = 0.0
        descent = np.zeros_like(embedding)
        for pairs in self.pair_sets:
            points = embedding[pairs.vertices]  # (p, d)
            points = points - points.mean(axis=0)  # near pairs lose nothing to the distance from the origin
            square = (points**2).sum(axis=1)
            one = np.ones(len(points))
            right = np.column_stack([points, one, square])  # |x - y|² = (-2 x, |x|², 1) · (y, 1, |y|²)
            left = np.column_stack([-2 * points, square, one])
            local = np.zeros_like(points)
            for start, target, weight in zip(_tiles(len(points)), pairs.targets, pairs.weights, strict=True):
                rows, columns = slice(start, start + len(target)), slice(start, None)
                value, at_rows, at_columns = self._tile(left[rows], right[rows], right[columns], target, weight)
                total += value
                local[rows] += at_rows
                local[columns] += at_columns
            descent[pairs.vertices] += local
        return total, descent

    def _tile(
        self, left: FloatArray, rows: FloatArray, columns: FloatArray, target: FloatArray, weight: FloatArray
    ) -> tuple[float, FloatArray, FloatArray]:
        """Sum one tile: its stress, and what it pulls at the points of its rows and of its columns."""
        self._monitor.check()
        nearest = 1e-7 * float(np.sqrt(columns[:, -1].max()))  # below, rounding is most of a distance
        distance, missing, force = (room[: target.size].reshape(target.shape) for room in self._room)
        np.matmul(left, columns.T, out=distance)
        np.abs(distance, out=distance)  # rounding may leave less than 0
        np.sqrt(distance, out=distance)
        np.subtract(target, distance, out=missing)
        np.multiply(weight, missing, out=force)
        value = float(np.einsum("ij,ij->", force, missing))
        distance[distance <= nearest] = np.inf  # the diagonal, and points that coincide: no direction, no force
        force /= distance
        pull_right = force @ columns[:, :-1]  # sums come with the products
        pull_left = force.T @ rows[:, :-1]
        at_rows = pull_right[:, -1:] * rows[:, :-2] - pull_right[:, :-1]
        at_columns = pull_left[:, -1:] * columns[:, :-2] - pull_left[:, :-1]
        return value, at_rows, at_columns


def _tiles(count: int) -> range:
    """List the first rows of the tiles of a set of so many vertices."""
    return range(0, count, int(np.clip(_TILE // max(count, 1), 1, _ROWS)))
