"""The mirror partner of each vertex: from the feature points to all vertices, by form and surface together."""

from __future__ import annotations

import numpy as np

from ..mesh.geometry import vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.nearest import nearest_rows
from ..numerics.products import product
from ..numerics.ramps import ramp
from ..run.monitor import Monitor
from .involutions import feature_involutions
from .limbs import Limbs
from .mirror import MirrorMap, Plane, mirror_plane

_NEAR, _FACING = 0.3, 0.08  # weights of position and normal relative to the distances from the feature points, and
_FACING_LAST, _SPECTRAL = 0.05, 0.2  # of normal and eigenfunctions relative to the position once a map is found
_SURE, _NONE = 0.12, 0.15  # mismatch up to which a surface is symmetric, and above which it is not
_EIGENPAIRS = (20, 50)  # of the rounds that refine the map
_ROUNDS = 2  # of plane and map, for each swap of the feature points


def mirror_partners(
    form: FloatArray,
    faces: IntArray,
    weights: FloatArray,
    eigenvectors: FloatArray,
    features: IntArray,
    to_features: FloatArray,
    limbs: Limbs,
    samples: IntArray,
    monitor: Monitor,
) -> MirrorMap | None:
    """Find the mirror symmetry of a surface.

    Every swap of feature points that keeps their distances gives a mirror plane of the form. The partner of a vertex is
    the one most similar to its mirror image, in position, normal and swapped distances from the feature points. The
    best swap is refined: the map becomes one between eigenfunctions of the surface, which with the mirrored positions
    gives a better map.

    Parameters
    ----------
    form : (n, 3) ndarray of float
        The surface with its limbs straight, of unit area.
    faces : (m, 3) ndarray of int
        Triangles.
    weights : (n,) ndarray of float
        Areas of the vertices.
    eigenvectors : (n, K) ndarray of float
        Eigenfunctions, orthonormal under the areas, lowest first.
    features : (k,) ndarray of int
        Feature points.
    to_features : (n, k) ndarray of float
        Geodesic distances from them.
    limbs : Limbs
        The limbs identified among the feature points.
    samples : (s,) ndarray of int
        Vertices spread over the surface, on which the swaps are compared.
    monitor : Monitor
        Polled for cancellation.

    Returns
    -------
    MirrorMap or None
        The map; None for a surface that is not its own mirror image.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> arms = np.array([[-2.0, 0, 0], [-1, 0, 0.1], [0, 0.5, 0], [0, -1, 0.2], [1, 0, 0.1], [2, 0, 0]])
    >>> faces = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 4], [2, 4, 5], [3, 5, 4]])
    >>> far = np.abs(arms[:, :1] - [-2.0, 2.0])
    >>> waves = np.linalg.qr(arms[:, :2])[0] * np.sqrt(6)
    >>> limbs = limbs_of(far[[0, 5]] / 3, np.zeros((2, 2, 2)), np.ones(2), lambda: np.array([0.0, 5]))
    >>> mirror = mirror_partners(
    ...     arms / 3, faces, np.ones(6) / 6, waves, np.array([0, 5]), far / 3, limbs, np.arange(6), Monitor())
    >>> mirror.partner.tolist()
    [5, 4, 2, 3, 1, 0]

    References
    ----------
    The map between eigenfunctions and its refinement: Melzi and others, "ZoomOut: Spectral Upsampling
    for Efficient Shape Correspondence", 2019, doi:10.1145/3355089.3356524.
    """
    normals = vertex_normals(form, faces)
    best, least = None, _NONE
    here = np.column_stack([to_features, _NEAR * form, _FACING * normals])
    for image, _ in feature_involutions(limbs.distances, limbs.handedness, limbs.adf, monitor=monitor):
        plane = mirror_plane(form[features], form[features[image]], np.ones(len(features)))
        for _ in range(_ROUNDS):
            there = _mirrored(form[samples], normals[samples], plane, _NEAR, _FACING, to_features[samples][:, image])
            partner = nearest_rows(there, here, monitor)
            plane = mirror_plane(form[samples], form[partner], np.ones(len(samples)))
        apart = plane.mirrored(form[partner]) - form[samples]
        changed = to_features[partner][:, image] - to_features[samples]
        mismatch = float(np.sqrt((apart**2).sum(axis=1).mean()) + np.sqrt((changed**2).mean()))
        if mismatch < least:
            best, least = (image, plane), mismatch
    if best is None:
        return None
    image, plane = best
    partner = nearest_rows(_mirrored(form, normals, plane, _NEAR, _FACING, to_features[:, image]), here, monitor)
    for count in _EIGENPAIRS:
        waves = eigenvectors[:, :count]
        turned = product(waves, product((waves * weights[:, None]).T, waves[partner]))
        scale = _SPECTRAL / np.sqrt(waves.shape[1])
        plane = mirror_plane(form, form[partner], weights)
        partner = nearest_rows(
            _mirrored(form, normals, plane, 1.0, _FACING_LAST, scale * turned),
            np.column_stack([scale * waves, form, _FACING_LAST * normals]),
            monitor,
        )
    return MirrorMap(partner, float(ramp(least, _NONE, _SURE)))


def _mirrored(
    form: FloatArray, normals: FloatArray, plane: Plane, near: float, facing: float, values: FloatArray
) -> FloatArray:
    """Stack mirrored values, positions and normals."""
    return np.column_stack([values, near * plane.mirrored(form), facing * plane.mirrored_vectors(normals)])
