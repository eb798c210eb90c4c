"""The mirror image of a form under a map that takes each vertex to its mirror partner."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..numerics.arrays import FloatArray, IntArray

_SMOOTHING = 0.01  # diffusion time of the displacement to the mean, as a share of the area: smaller details may differ
_ROUNDS = 2  # each recomputes the plane


class Plane(NamedTuple):
    """A mirror plane.

    Attributes
    ----------
    normal : (3,) ndarray of float
        Unit normal.
    point : (3,) ndarray of float
        Any point of it.
    """

    normal: FloatArray
    point: FloatArray

    def mirrored(self, points: FloatArray) -> FloatArray:
        """Mirror points. `points` (n, 3); gives (n, 3)."""
        return self.mirrored_vectors(points - self.point) + self.point

    def mirrored_vectors(self, vectors: FloatArray) -> FloatArray:
        """Mirror directions. `vectors` (n, 3); gives (n, 3)."""
        return np.asarray(vectors - 2.0 * (vectors @ self.normal)[:, None] * self.normal)


class MirrorMap(NamedTuple):
    """The mirror symmetry of a surface.

    Attributes
    ----------
    partner : (n,) ndarray of int
        The mirror partner of each vertex.
    sure : float
        Degree of symmetry, from 0 for a surface that is not symmetric to 1.
    """

    partner: IntArray
    sure: float


def mirror_plane(points: FloatArray, partners: FloatArray, weights: FloatArray) -> Plane:
    """Find the plane that best mirrors points onto their partners.

    `points, partners` (n, 3); `weights` (n,).

    Examples
    --------
    >>> points = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 3, 1], [0, -2, 4]])
    >>> np.abs(mirror_plane(points, points * [-1, 1, 1], np.ones(4)).normal).round(6).tolist()
    [1.0, 0.0, 0.0]
    """
    share = weights / weights.sum()
    centre = share @ (points + partners) / 2
    turned = (share[:, None] * (points - centre)).T @ (partners - centre)
    return Plane(np.linalg.eigh(turned + turned.T)[1][:, 0], centre)  # |b - (I - 2nnᵀ)a|² is least where nᵀ(abᵀ)n is


def asymmetry(form: FloatArray, partner: IntArray, weights: FloatArray) -> float:
    """Measure the deviation of a form from its mirror image.

    `form` (n, 3); `partner` (n,); `weights` (n,).

    Examples
    --------
    >>> form = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 3, 1], [0, -2, 4]])
    >>> round(asymmetry(form, np.array([1, 0, 2, 3]), np.ones(4)), 6)
    0.0
    """
    way = _way_to_image(form, partner, weights)
    return float(np.sqrt(weights @ (way**2).sum(axis=1) / weights.sum()))


def held_symmetric(body: ElasticBody, form: FloatArray, mirror: MirrorMap) -> FloatArray:
    """Move a form to the mean of itself and its mirror image, to the degree that the surface is symmetric.

    Details smaller than a limb keep their differences: the displacement to the mean is smoothed over the surface.

    `body`: the surface; `form` (n, 3); `mirror`: its mirror symmetry; gives (n, 3).
    """
    for _ in range(_ROUNDS):
        way = _way_to_image(form, mirror.partner, body.mass)
        form = form + mirror.sure / 2 * body.smoothed(way * body.mass[:, None], _SMOOTHING)
    return form


def _way_to_image(form: FloatArray, partner: IntArray, weights: FloatArray) -> FloatArray:
    """Compute the displacement of each vertex to the mirror image of its partner."""
    image = form[partner]
    return mirror_plane(form, image, weights).mirrored(image) - form
