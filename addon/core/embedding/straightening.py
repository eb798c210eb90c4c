"""The straight arrangement: limbs are pushed straight and apart, and get the lengths of the surface back."""

from __future__ import annotations

import numpy as np

from ..deformation.detail import relaxed
from ..deformation.elastic_body import ElasticBody
from ..deformation.twists import untwisted
from ..mesh.edges import pairs_across_edges
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.nearest import nearest_others
from ..run.monitor import Monitor
from .pushing import Pushing

_STRENGTH = 40.0  # of the push: thin limbs grow by half and more, and no joint withstands it
_TIP = 0.02  # of the distance to the next feature point: the end of a limb, which the landmarks push, too
_TIP_SHARE = 0.4  # of the push that ends get: without it, there is no tension there, and they stay bent
_BENDING = 2.0  # stiffness between vertices across an edge, which keeps the surface from crumpling
_EVEN = 3**-0.5  # stiffness in the shell of an edge between equilateral triangles
_STIFFEST = 50.0  # over that
_AVERAGED = 0.15  # diffusion time of the stretch that is taken back, as a share of the area: lengths are those of limbs
_RELAXING_STEPS = 4  # that smooth what the push crumpled


def straightened(
    body: ElasticBody,
    faces: IntArray,
    form: FloatArray,
    landmarks: IntArray,
    depth: float,
    features: IntArray,
    to_features: FloatArray,
    *,
    max_iterations: int = 300,
    tolerance: float = 1e-3,
    extrapolation: int = 6,
    monitor: Monitor,
) -> FloatArray:
    """Arrange the limbs as straight and as far apart as their lengths allow.

    Landmarks push each other and the ends of the limbs apart, so hard that limbs grow. Only the directions of what
    comes out count: the stretch, averaged over an area as wide as a limb is long, is taken back.

    Parameters
    ----------
    body : ElasticBody
        The surface.
    faces : (m, 3) ndarray of int
        Its triangles.
    form : (n, 3) ndarray of float
        Where the push begins; it hardly matters, beyond the side of each limb.
    landmarks : (l,) ndarray of int
        Vertices that push each other.
    depth : float
        How much of a push along the third axis counts: 0 where mirror images are a tie, 1 where they are none.
    features : (k,) ndarray of int
        Feature points.
    to_features : (n, k) ndarray of float
        Distances of all vertices from them.
    max_iterations, tolerance, extrapolation
        As in `Pushing.lowered`.
    monitor : Monitor
        Receives progress; polled for cancellation.

    Returns
    -------
    (n, 3) ndarray of float
        The arrangement.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> far = np.linalg.norm(points[:, None] - points, axis=2)
    >>> form = straightened(body, faces, points, np.arange(4), 1.0, np.arange(4), far, monitor=Monitor())
    >>> lengths = np.linalg.norm(form[faces[:, 0]] - form[faces[:, 1]], axis=1)
    >>> np.allclose(lengths, np.sqrt(8), rtol=1e-3)
    True

    References
    ----------
    The push: Pickup and others, "Euclidean-distance-based canonical forms for non-rigid 3D shape retrieval", 2015,
    doi:10.1016/j.patcog.2015.02.021.
    """
    edges, stiffness = body.shell()
    across = pairs_across_edges(faces)
    tips = []
    if len(features) > 1:
        tips, form = _tips(features, to_features), untwisted(body, form, features, to_features)
    pushing = Pushing(
        body.points,
        np.concatenate([edges, across]),
        landmarks,
        strength=_STRENGTH,
        depth=depth,
        stiffness=np.concatenate([np.minimum(stiffness / _EVEN, _STIFFEST), np.full(len(across), _BENDING)]),
        tips=tips,
        tip_share=_TIP_SHARE if tips else 0.0,
    )
    form, _ = pushing.lowered(
        form, max_iterations=max_iterations, tolerance=tolerance, extrapolation=extrapolation, monitor=monitor
    )
    form = relaxed(body, body.without_stretch(form, _AVERAGED), _RELAXING_STEPS, monitor)
    return body.without_stretch(form, _AVERAGED)


def _tips(features: IntArray, to_features: FloatArray) -> list[IntArray]:
    """List the vertices at the end of each limb."""
    reach = _TIP * nearest_others(to_features[features])
    return [np.flatnonzero(away <= most) for away, most in zip(to_features.T, reach, strict=True)]
