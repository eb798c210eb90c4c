"""The stress of equation 10 as sums over sets of pairs: patches and feature points."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

# Pairs in a tile, and rows at most: they fit the cache, a cancellation is noticed between them, and their products are
# small enough that a linear algebra library runs them on one thread; more would wait for each other longer than this
# takes.
_TILE = 64**3 // 5  # times 5 columns
_ROWS = 128


class PairList(NamedTuple):
    """Some single pairs, each with a wanted distance and a weight.

    Attributes
    ----------
    pairs : (k, 2) ndarray of int
        Positions of both ends in the vertices of a `PairSet`.
    targets : (k,) ndarray of float
        Wanted distances.
    weights : (k,) ndarray of float
        Weights.
    """

    pairs: IntArray
    targets: FloatArray
    weights: FloatArray


NO_PAIRS = PairList(np.empty((0, 2), dtype=np.int64), np.empty(0), np.empty(0))


@dataclass(frozen=True, eq=False)
class PairSet:
    """All pairs of some vertices, the sources, with themselves and others: wanted distances and weights, in tiles.

    A tile holds the rows of some sources and the columns from the first of them to the last vertex; what lies on or
    below the diagonal has weight 0. Every pair is stored once.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        The vertices, sources first.
    targets : list of (r, c) ndarray of float
        Wanted distances, tile by tile.
    weights : list of (r, c) ndarray of float
        Weights, tile by tile.
    further : PairList
        Single pairs beside those of the tiles.
    """

    vertices: IntArray
    targets: list[FloatArray]
    weights: list[FloatArray]
    further: PairList = NO_PAIRS

    def tiles(self) -> Iterator[tuple[int, FloatArray, FloatArray]]:
        """Iterate over the tiles.

        Yields
        ------
        start : int
            Position of the first row, and of the first column, in `vertices`.
        targets : (r, c) ndarray of float
            Wanted distances.
        weights : (r, c) ndarray of float
            Weights.
        """
        start = 0
        for target, weight in zip(self.targets, self.weights, strict=True):
            yield start, target, weight
            start += len(target)

    @property
    def source_count(self) -> int:
        """Number of sources s."""
        return sum(map(len, self.targets))

    @property
    def pair_count(self) -> int:
        """Number of pairs, counted both ways like the entries of a matrix: p² if all vertices are sources."""
        count = len(self.vertices)
        return count**2 - (count - self.source_count) ** 2 + 2 * len(self.further.pairs)

    def total_weights(self) -> FloatArray:
        """Sum the weights of the pairs that each vertex is in.

        Returns
        -------
        (p,) ndarray of float
            Total weight by vertex: the diagonal of V.
        """
        total = np.zeros(len(self.vertices))
        for start, _, weight in self.tiles():
            total[start : start + len(weight)] += weight.sum(axis=1)
            total[start:] += weight.sum(axis=0)
        pairs, _, weights = self.further
        return total + np.bincount(pairs.ravel(), np.repeat(weights, 2), minlength=len(total))

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
        return PairSet(
            self.vertices,
            self.targets,
            [factor * weight for weight in self.weights],
            self.further._replace(weights=factor * self.further.weights),
        )

    def laplacian(self, monitor: Monitor | None = None) -> tuple[FloatArray, csc_matrix]:
        """Assemble V of these pairs, ``-w_ij`` off the diagonal, row sums 0, in two parts.

        Parameters
        ----------
        monitor : Monitor, optional
            Polled for cancellation between tiles.

        Returns
        -------
        of_sources : (s, p) ndarray of float
            The rows of the sources.
        among_others : (p - s, p - s) scipy.sparse.csc_matrix
            The rows and columns of the others, nearly diagonal.
        """
        from scipy.sparse import coo_matrix

        total, sources = self.total_weights(), self.source_count
        rows = np.zeros((sources, len(total)))
        for start, _, weight in self.tiles():
            if monitor is not None:
                monitor.check()
            stop = start + len(weight)
            rows[start:stop, start:] -= weight
            rows[start:, start:stop] -= weight[:, : sources - start].T
        pairs, _, heavy = self.further
        one, two = np.concatenate([pairs, pairs[:, ::-1]]).T
        weight = np.tile(heavy, 2)
        of_source = one < sources
        np.subtract.at(rows, (one[of_source], two[of_source]), weight[of_source])
        np.fill_diagonal(rows, total[:sources])
        among = ~of_source & (two >= sources)
        diagonal = np.arange(len(total) - sources)
        entries = np.concatenate([-weight[among], total[sources:]])
        places = np.concatenate([one[among] - sources, diagonal]), np.concatenate([two[among] - sources, diagonal])
        return rows, coo_matrix((entries, places), shape=(len(diagonal), len(diagonal))).tocsc()


def pair_set(
    vertices: IntArray, distances: FloatArray, weights: Callable[[slice, slice, FloatArray], FloatArray]
) -> PairSet:
    """Store all pairs of some sources with themselves and other vertices in tiles.

    Parameters
    ----------
    vertices : (p,) ndarray of int
        The vertices, the s sources first.
    distances : (s, p) ndarray of float
        Wanted distances from the sources; the part above the diagonal is read.
    weights : callable
        Gives the weights of a tile from its rows (a slice of 0 to s), its columns (a slice of 0 to p) and its wanted
        distances.

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
    starts = _starts(len(distances), len(vertices))
    for start in starts:
        rows, columns = slice(start, min(start + starts.step, len(distances))), slice(start, len(vertices))
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
        largest = max((target.size for pairs in pair_sets for target in pairs.targets), default=0)
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
            for start, target, weight in pairs.tiles():
                rows, columns = slice(start, start + len(target)), slice(start, None)
                value, at_rows, at_columns = self._tile(left[rows], right[rows], right[columns], target, weight)
                total += value
                local[rows] += at_rows
                local[columns] += at_columns
            if len(pairs.further.pairs):
                total += _add_list(pairs.further, points, local)
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


def _add_list(listed: PairList, points: FloatArray, pull: FloatArray) -> float:
    """Sum single pairs: add what they pull at the points, and return their stress."""
    (one, two), target, weight = listed.pairs.T, listed.targets, listed.weights
    way = points[one] - points[two]
    distance = np.sqrt((way**2).sum(axis=1))
    missing = target - distance
    force = weight * missing
    value = float(force @ missing)
    force /= np.where(distance > 0, distance, np.inf)
    for axis, along in enumerate((force[:, None] * way).T):
        pull[:, axis] += np.bincount(one, along, minlength=len(pull)) - np.bincount(two, along, minlength=len(pull))
    return value


def _starts(sources: int, count: int) -> range:
    """List the first rows of the tiles of so many sources and vertices."""
    return range(0, sources, int(np.clip(_TILE // max(count, 1), 1, _ROWS)))
