"""Points push each other apart while the edges of the mesh keep their lengths."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from .smacof import minimise_stress

_FAR = 10.0  # distance that every pair is asked for, in units of sqrt(area): more than any body can give
_PATIENCE = 1e-3  # times the tolerance: most of this stress is what no body can reach, and never falls
_LEAST = 1e-12  # distance below which a direction means nothing


class LinkStress:
    """The stress of a list of links: ``Σ w (t - d)²``.

    Parameters
    ----------
    links : (e, 2) ndarray of int
        Pairs of points.
    targets : (e,) ndarray of float
        Wanted lengths.
    weights : (e,) ndarray of float
        Weights.
    count : int
        Number n of points.

    Examples
    --------
    >>> stress = LinkStress(np.array([[0, 1]]), np.array([3.0]), np.array([1.0]), 2)
    >>> value, descent = stress.value_and_descent(np.array([[0.0, 0, 0], [1, 0, 0]]))
    >>> value, descent[:, 0].tolist()
    (4.0, [-2.0, 2.0])
    """

    def __init__(self, links: IntArray, targets: FloatArray, weights: FloatArray, count: int) -> None:
        from scipy.sparse import csr_matrix

        self._i, self._j = links.T
        self._targets, self._weights = targets, weights
        ends, start = links.ravel(), 2 * np.arange(len(links) + 1)
        values = np.tile([1.0, -1.0], len(links))
        self._differences = csr_matrix((values, ends, start), shape=(len(links), count))
        self._to_ends = self._differences.T.tocsr()

    def value_and_descent(self, points: FloatArray) -> tuple[float, FloatArray]:
        """Compute the stress and ``(B(X) - V) X``, minus half its gradient.

        Parameters
        ----------
        points : (n, 3) ndarray of float
            X.

        Returns
        -------
        value : float
            The stress.
        descent : (n, 3) ndarray of float
            Minus half the gradient.
        """
        apart = points[self._i] - points[self._j]
        length = np.maximum(np.sqrt(np.einsum("ij,ij->i", apart, apart)), _LEAST)
        short = self._targets - length
        value = float(self._weights @ short**2)
        return value, np.asarray(self._to_ends @ ((self._weights * short / length)[:, None] * apart))

    def inverse(self) -> Callable[[FloatArray], FloatArray]:
        """Factor V.

        Returns
        -------
        callable
            V⁺, for right-hand sides whose sum is 0.
        """
        from scipy.sparse import diags, eye

        V = self._to_ends @ diags(self._weights) @ self._differences
        solve = factored(V + 1e-9 * V.diagonal().mean() * eye(V.shape[0])).solve
        return lambda descent: solve(np.ascontiguousarray(descent))


class Pushing:
    """Edges that keep their lengths, and pairs that want a distance no body reaches: a nearly constant push.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices, of unit area.
    edges : (e, 2) ndarray of int
        Pairs of vertices that keep their distances.
    samples : (s,) ndarray of int
        The vertices that push each other.
    strength : float
        Sum of the pushes, in units of sqrt(area); an edge that is longer than it should be by d pulls with d times its
        stiffness. How much a mesh gives way hardly depends on how fine it is.
    depth : float
        How much of a push along the third axis counts, 0 to 1.
    stiffness : (e,) ndarray of float, optional
        Stiffness of each edge; 1 when left out.
    tips : sequence of (t,) ndarray of int
        Ends of limbs, each a group of vertices. The samples push them too, each group as strongly as any other, so that
        a limb is under tension up to its end.
    tip_share : float
        Share of the push that the tips get, 0 to 1.
    normalised : bool
        Push each pair by as much more as it lies nearer to each other, so that near pairs, which a bent joint brings
        together, have as much say as far ones.

    Examples
    --------
    >>> folded = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 0.9]])
    >>> pushing = Pushing(folded, np.array([[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]), np.array([0, 3]), strength=0.5)
    >>> form, _ = pushing.lowered(folded)
    >>> bool(np.linalg.norm(form[3] - form[0]) > 1.2 * np.linalg.norm(folded[3] - folded[0]))
    True
    """

    def __init__(
        self,
        points: FloatArray,
        edges: IntArray,
        samples: IntArray,
        *,
        strength: float,
        depth: float = 1.0,
        stiffness: FloatArray | None = None,
        tips: Sequence[IntArray] = (),
        tip_share: float = 0.0,
        normalised: bool = False,
    ) -> None:
        count = len(points)
        lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        first, second = np.triu_indices(len(samples), 1)
        pairs = np.column_stack([samples[first], samples[second]])
        push = np.ones(len(pairs))
        if normalised:
            push /= np.maximum(np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1), _LEAST)
        push *= (1 - tip_share) * strength / (_FAR * push.sum())
        for tip in tips:
            others = np.setdiff1d(samples, tip)
            pulled = np.column_stack([np.repeat(tip, len(others)), np.tile(others, len(tip))])
            share = tip_share * strength / (_FAR * len(tips) * max(len(pulled), 1))
            pairs, push = np.concatenate([pairs, pulled]), np.concatenate([push, np.full(len(pulled), share)])
        far = np.full(len(pairs), _FAR)
        stiffness = np.ones(len(edges)) if stiffness is None else stiffness
        self._kept = LinkStress(edges, lengths, stiffness, count)
        self._pushed = LinkStress(pairs, far, push, count)
        self._axes = np.array([1.0, 1.0, depth])
        self._all = LinkStress(
            np.concatenate([edges, pairs]), np.concatenate([lengths, far]), np.concatenate([stiffness, push]), count
        )

    def value_and_descent(self, points: FloatArray) -> tuple[float, FloatArray]:
        """Compute the stress and minus half its gradient.

        Parameters
        ----------
        points : (n, 3) ndarray of float
            X.

        Returns
        -------
        value : float
            The stress.
        descent : (n, 3) ndarray of float
            Minus half the gradient.
        """
        kept, descent = self._kept.value_and_descent(points)
        pushed, push = self._pushed.value_and_descent(points * self._axes)
        return kept + pushed, descent + push * self._axes

    def lowered(
        self,
        start: FloatArray,
        *,
        max_iterations: int = 300,
        tolerance: float = 1e-3,
        extrapolation: int = 6,
        monitor: Monitor | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Move the vertices until the edges withstand the push.

        Parameters
        ----------
        start : (n, 3) ndarray of float
            Where they start.
        max_iterations, tolerance, extrapolation
            As in `minimise_stress`; the tolerance is taken a thousand times finer.
        monitor : Monitor
            Receives progress; polled for cancellation.

        Returns
        -------
        form : (n, 3) ndarray of float
            The vertices, centred.
        history : (s + 1,) ndarray of float
            The stress; it never rises.

        Raises
        ------
        CancelledError
            If the run is cancelled.
        """
        inverse = self._all.inverse()  # of a V that is never too small, whatever the depth
        return minimise_stress(
            self,
            inverse,
            start,
            max_iterations=max_iterations,
            tolerance=_PATIENCE * tolerance,
            extrapolation=extrapolation,
            monitor=monitor,
        )
