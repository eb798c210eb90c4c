"""Feature points identified from the surface: head, tail, and limbs in pairs, left and right."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.nearest import nearest_others
from ..run.monitor import Monitor
from .chirality import sided
from .involutions import feature_involutions

_SYMMETRIC = 0.1  # mismatch of a swap above which a surface counts as having no left and right
_TOLD = 0.002  # minimum handedness, a cubed length, that distinguishes left from right,
TOLD_WEAKLY = 0.022  # and by three limbs, or where bridges join parts: a hand is nearer a sleeve in some poses
_ALIKE = 0.1  # prominences that differ by less count as equal


class Limbs(NamedTuple):
    """The limbs identified among the k feature points of a surface of n vertices."""

    distances: FloatArray  # (k, k) geodesic, symmetric, on a surface of unit area
    handedness: FloatArray  # (k, k, k) chirality of the distances from them
    adf: FloatArray  # (k,) Auto Diffusion Function there
    partner: IntArray  # (k,) mirror partner of each; itself in the middle, and for all without left and right
    side: IntArray  # (k,) 1 on the left, -1 on the right, 0 in the middle
    along: FloatArray  # (k,) weights with which distances from them add up to a function that rises towards the head
    margin: float  # by how much the swap with the partners fits better than the next best; 0 without left and right
    features: IntArray  # (k,) vertices of the surface
    to_features: FloatArray  # (n, k) geodesic distances of all vertices from them
    named: tuple[str, ...] = ()  # names given by hand, one for each, "" for none; empty where none was given

    @property
    def tell_sides(self) -> bool:
        """Whether the distances on the surface tell left from right: those of a body on all fours do."""
        return self.told >= 1.0

    @property
    def told(self) -> float:
        """How surely they tell it: from 1 on they do; infinite where names given by hand do."""
        if any(self.named):
            return np.inf
        return abs(sided(self.handedness, self.side, self.along)) / TOLD_WEAKLY

    def ends(self, share: float) -> list[IntArray]:
        """List the vertices at the end of each limb: within a share of the way to the next feature point.

        Empty where there is only one limb, which has no other to be pulled from.
        """
        if len(self.features) < 2:
            return []
        reach = share * nearest_others(self.distances)
        return [np.flatnonzero(away <= most) for away, most in zip(self.to_features.T, reach, strict=True)]

    def on_surface(self, features: IntArray, to_features: FloatArray) -> Limbs:
        """Locate the feature points among the vertices of a surface."""
        return self._replace(features=features, to_features=to_features)

    def like(self, other: Limbs) -> Limbs:
        """Take head, tail, sides and names from the same limbs in another pose."""
        return self._replace(
            partner=other.partner, side=other.side, along=other.along, margin=other.margin, named=other.named
        )

    def sorted_by(self, order: IntArray) -> Limbs:
        """Reorder the feature points.

        `order` (k,).

        Examples
        --------
        >>> distances = np.array([[0.0, 2, 1], [2, 0, 1], [1, 1, 0]])
        >>> limbs = limbs_of(distances, np.zeros((3, 3, 3)), np.array([2.0, 2, 1]), lambda: np.arange(3.0))
        >>> limbs.sorted_by(np.array([2, 1, 0])).side.tolist()
        [0, -1, 1]
        """
        place = np.empty(len(order), dtype=np.int64)
        place[order] = np.arange(len(order))
        return Limbs(
            self.distances[np.ix_(order, order)],
            self.handedness[np.ix_(order, order, order)],
            self.adf[order],
            place[self.partner[order]],
            self.side[order],
            self.along[order],
            self.margin,
            self.features[order],
            self.to_features[:, order],
            tuple(self.named[each] for each in order) if self.named else (),
        )


class BodyLimbs(NamedTuple):
    """A body of a mesh and the limbs identified among its feature points.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        Vertices of its surface, riders left out.
    tips : (k,) ndarray of int
        Its feature points, as positions in `vertices`.
    numbers : (k,) ndarray of int
        Indices of its feature points among those of the mesh.
    limbs : Limbs
        The limbs identified among them.
    """

    vertices: IntArray
    tips: IntArray
    numbers: IntArray
    limbs: Limbs


def limbs_of(
    distances: FloatArray,
    handedness: FloatArray,
    adf: FloatArray,
    places: Callable[[], FloatArray],
    *,
    joined: bool = False,
    monitor: Monitor | None = None,
) -> Limbs:
    """Identify head, tail, left and right among the feature points.

    The head is the broadest of those in the middle, where the Auto Diffusion Function is lowest; the tail the thinnest,
    if there are two. Limbs of one side are closer to each other than to those of the other side. Which side is left
    follows from handedness: a body has its limbs on its front, or underneath, so the side where distances from them are
    shorter is the front; front, head and outside determine left. If they do not, or hardly (arms without legs), the
    order of the vertices does.

    `distances` (k, k); `handedness` (k, k, k); `adf` (k,); `places`: returns the position of each of their limbs in
    the order of the vertices, (k,) ndarray of float; called if nothing else distinguishes left from right; `joined`:
    whether the surface consists of several parts with bridges between them.

    Examples
    --------
    >>> from scipy.spatial.distance import cdist
    >>> body = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0]]) / 3
    >>> limbs = limbs_of(cdist(body, body), np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    >>> limbs.partner.tolist(), limbs.side.tolist()
    ([1, 0, 3, 2, 4], [1, -1, 1, -1, 0])
    """
    count = len(distances)
    partner = np.arange(count)
    swaps = feature_involutions(distances, handedness, adf, most=2, monitor=monitor)
    mismatch = [each for _, each in swaps] + [np.inf] * 2
    margin = 0.0
    if mismatch[0] < _SYMMETRIC:
        partner, margin = swaps[0][0], mismatch[1] - mismatch[0]
    along = _along(partner, adf)
    ones = np.flatnonzero(partner > np.arange(count))
    others = partner[ones]
    far = distances[np.ix_(ones, others)]
    beside = distances[np.ix_(ones, ones)] + distances[np.ix_(others, others)]
    same = far + far.T - beside  # (p, p) above 0 where the pairs are numbered from the same side
    np.fill_diagonal(same, 0.0)
    side = np.zeros(count, dtype=np.int64)
    if len(ones):
        agree = np.where(np.linalg.eigh(same)[1][:, -1] >= 0, 1, -1)
        side[ones], side[others] = agree, -agree
        told = sided(handedness, side, along)
        if abs(told) < (TOLD_WEAKLY if joined or count == 3 else _TOLD):
            told = float(places() @ -side)
        side = side if told >= 0 else -side
    return Limbs(distances, handedness, adf, partner, side, along, margin, np.arange(count), distances)


def lasting_order(limbs: Limbs, prominence: FloatArray, vertices: IntArray) -> IntArray:
    """Sort feature points so that similar limbs of similar surfaces get the same position, whatever the pose.

    Those in the middle come first, from head to tail; then the pairs, from the head backwards, each with its left one
    first. On a surface without left and right the most prominent come first; equally prominent ones are sorted by
    vertex.

    `limbs`: head, tail and sides; `prominence` (k,); `vertices` (k,); gives (k,).

    Examples
    --------
    >>> distances = np.array([[0.0, 2, 1], [2, 0, 1], [1, 1, 0]])
    >>> limbs = limbs_of(distances, np.zeros((3, 3, 3)), np.array([2.0, 2, 1]), lambda: np.arange(3.0))
    >>> lasting_order(limbs, np.ones(3), np.arange(3)).tolist()
    [2, 0, 1]
    """
    count = len(vertices)
    if not limbs.side.any():
        falling = np.argsort(-prominence, kind="stable")
        level = np.empty(count, dtype=np.int64)
        level[falling] = np.concatenate([[0], np.cumsum(np.diff(prominence[falling]) < -_ALIKE)])
        return np.lexsort((vertices, level))
    ahead = limbs.distances @ limbs.along
    ahead = (ahead + ahead[limbs.partner]) / 2
    pair = np.minimum(np.arange(count), limbs.partner)
    return np.lexsort((-limbs.side, pair, -ahead, limbs.side != 0))


def _along(partner: IntArray, adf: FloatArray) -> FloatArray:
    """Weigh distances so that their sum increases towards the head: minus those from it, plus those from the tail."""
    weights = np.zeros(len(partner))
    middle = np.flatnonzero(partner == np.arange(len(partner)))
    if len(middle):
        head, tail = middle[np.argmin(adf[middle])], middle[np.argmax(adf[middle])]
        weights[tail] += 1.0
        weights[head] -= 1.0
    if not weights.any():  # a single one in the middle leads, or without any, the broadest pair
        first = int(np.argmin(adf + adf[partner])) if not len(middle) else int(middle[0])
        weights[first] -= 0.5
        weights[partner[first]] -= 0.5
    return weights
