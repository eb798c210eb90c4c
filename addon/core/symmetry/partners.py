"""The mirror partner of each vertex: from the feature points to all vertices, by form and surface together."""

from __future__ import annotations

import numpy as np

from ..deformation.elastic_body import ElasticBody
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
    body: ElasticBody,
    form: FloatArray,
    eigenvectors: FloatArray,
    limbs: Limbs,
    samples: IntArray,
    monitor: Monitor,
) -> MirrorMap | None:
    """Find the mirror symmetry of a body from a form of it with straight limbs; None if it has none.

    Every swap of feature points that keeps their distances gives a mirror plane of the form. The partner of a vertex is
    the one most similar to its mirror image, in position, normal and swapped distances from the feature points. Swaps
    are compared on some samples, vertices spread over the surface. The best is refined: the map becomes one between
    eigenfunctions (orthonormal under the areas), which with the mirrored positions gives a better map.
    """
    faces, weights, features, to_features = body.faces, body.mass, limbs.features, limbs.to_features
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
