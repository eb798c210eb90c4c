"""From a match of the working vertices to one of all vertices, with points on the triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..measures.alignment import rigid_fit
from ..mesh.closest_points import SurfacePoints, closest_points
from ..mesh.geometry import area_vectors, vertex_areas, vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..numerics.ramps import ramp
from ..run.monitor import Monitor
from .conformal_metric import with_areas_of
from .elastic_fit import elastic_fit, with_normals
from .sides import Side
from .spectral_map import first_map, on_triangles, refined
from .unfolded import Unfolded

_COUNTS = range(20, 121, 5)  # eigenfunctions, round by round
_FEWER = range(20, 121, 10)  # between unlike bodies: there a trunk slides a little in each round
_ROUGH = range(20, 61, 10)  # of the map that tells how their areas differ
_ALIKE = -4.0  # score up to which bodies are alike
_BACK = (110, 120)  # eigenfunctions of the way back, by which the confidence is told
_NEAR = 0.3  # weight of positions on the form
_SMOOTH = 2e-4  # diffusion time of the confidence, as a share of the area
_LOST = 0.08  # sqrt(area): round-trip error that counts as wrong
_TURNED = 0.5  # cosine between normals below which a match counts as wrong
_GROWN = np.log(3.0)  # change of the logarithm of the area that counts as wrong


class PointMap(NamedTuple):
    """For every vertex of a surface, the corresponding point of another.

    Attributes
    ----------
    points : SurfacePoints
        Points of the other surface, on all its triangles; for all vertices.
    confidence : (n,) ndarray of float
        Confidence of each point, 0 to 1.
    score : float
        Score of the match, that of its side.
    """

    points: SurfacePoints
    confidence: FloatArray
    score: float


class WorkingMap(NamedTuple):
    """For every working vertex of a surface, the corresponding point of another's working surface.

    Attributes
    ----------
    points : SurfacePoints
        Points on the triangles of the other working surface.
    confidence : (c,) ndarray of float
        Confidence of each, 0 to 1.
    placed : (c, 3) ndarray of float
        The form, moved onto the other.
    rotation, shift : (3, 3), (3,) ndarray of float
        The rigid part of that motion, ``x ↦ x R + t``.
    """

    points: SurfacePoints
    confidence: FloatArray
    placed: FloatArray
    rotation: FloatArray
    shift: FloatArray


def point_map(one: Unfolded, other: Unfolded, side: Side, monitor: Monitor) -> PointMap:
    """Match all vertices of a surface with points of another.

    The map between the working vertices moves one form onto the other, as rigidly as possible. The displacements are
    interpolated to all vertices; the point of the other form closest to each moved vertex is its match.

    `one, other`: the surfaces; `side`: the side on which they are matched.

    Examples
    --------
    >>> from addon.core.matching.unfolded import unfolded
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> from addon.core.matching.sides import sides
    >>> point_map(body, body, sides(body, body, Monitor())[0], Monitor()).points.weights.max(axis=1).round(6).tolist()
    [1.0, 1.0, 1.0, 1.0]
    """
    found = working_map(one, other, side, monitor, scaled=True)
    way = found.placed - (one.form @ found.rotation + found.shift)
    normals = vertex_normals(one.whole_form, one.found.whole_faces) @ found.rotation
    wanted = one.whole_form @ found.rotation + found.shift + one.found.surface.prolong(way)  # (n, 3)
    whole = other.found.whole_faces
    monitor.check()
    others = with_normals(other.whole_form, vertex_normals(other.whole_form, whole))
    points = closest_points(others, whole, with_normals(wanted, normals), monitor)
    return PointMap(points, np.clip(one.found.surface.prolong(found.confidence), 0.0, 1.0), side.score)


def working_map(one: Unfolded, other: Unfolded, side: Side, monitor: Monitor, *, scaled: bool = False) -> WorkingMap:
    """Match the working vertices of a surface with points of another: the part of `point_map` that takes long.

    `one, other`: the surfaces; `side`: the side on which they are matched; `scaled`: whether an unlike body gets the
    areas of the other, which those of skin that may have grown together do not tell.
    """
    from scipy.sparse import diags

    body = ElasticBody(one.found.stiffness, one.found.mass, one.form, one.faces)
    unlike, resized = side.score > _ALIKE, one
    counts = _FEWER if unlike else _COUNTS
    first = first_map(one, other, side.start, monitor)
    if unlike and scaled:
        resized = with_areas_of(one, other, refined(one, other, first, _ROUGH, _NEAR, monitor), monitor)
    partner = refined(resized, other, first, counts, _NEAR, monitor)  # from the first map again, which has not slid
    there = on_triangles(resized, other, partner, counts[-1], _NEAR, monitor)
    placed, there = elastic_fit(body, one, other, there, monitor)
    partner = there.nearest_corners(other.faces)
    rotation, shift = rigid_fit(one.form, other.form[partner], one.areas)
    monitor.check()
    time = _SMOOTH * one.found.mass.sum()
    smooth = factored(diags(one.found.mass) + time * one.found.stiffness).solve
    reached = there.on(other.form, other.faces)
    sure = np.clip(smooth(one.found.mass * _confidence(resized, other, partner, reached, rotation, monitor)), 0.0, 1.0)
    return WorkingMap(there, sure, placed, rotation, shift)


def _confidence(
    one: Unfolded, other: Unfolded, partner: IntArray, places: FloatArray, rotation: FloatArray, monitor: Monitor
) -> FloatArray:
    """Compute the confidence of a map from its round-trip error, normals, and area and orientation of triangles."""
    back = refined(other, one, _first_back(other, partner), _BACK, _NEAR, monitor)
    home = np.linalg.norm(one.form[back[partner]] - one.form, axis=1)
    facing = np.einsum("ij,ij->i", one.normals @ rotation, other.normals[partner])
    before, after = area_vectors(one.form @ rotation, one.faces), area_vectors(places, one.faces)
    kept = np.einsum("ij,ij->i", before, after) > 0
    tiny = np.finfo(float).tiny
    corners, count = one.faces.ravel(), len(one.form)
    share = np.bincount(corners, np.repeat(kept, 3), count) / np.maximum(np.bincount(corners, minlength=count), 1)
    grown = np.abs(np.log((vertex_areas(places, one.faces) + tiny) / (vertex_areas(one.form, one.faces) + tiny)))
    return np.asarray(
        np.exp(-((home / _LOST) ** 2)) * ramp(facing, _TURNED, 1.0) ** 0.5 * share * np.exp(-((grown / _GROWN) ** 2))
    )


def _first_back(other: Unfolded, partner: IntArray) -> IntArray:
    """Initialise the inverse map: each vertex of the other surface maps to the source of the nearest image."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(other.form[partner]).query(other.form)[1])
