"""The task of a worker on a published benchmark: match one pair as it comes, and measure it at the true points."""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np

from ...core.mesh.geometry import surface_area, vertex_areas
from ...core.numerics.arrays import FloatArray, IntArray
from ...core.surface.laplacian import stiffness
from ...core.surface.triangulation import triangulated
from ..work import one_thread
from .matchers import MATCHERS, Mesh
from .work import distances_to

CURVE = np.linspace(0.0, 0.25, 51)  # sqrt(area): error bounds of the Princeton curve


class Measured(NamedTuple):
    """Result of one pair and one method of matching.

    Attributes
    ----------
    row : dict
        ``error`` (of the nearest vertices, as published ones are), ``points`` (of the points between them),
        ``mirrored`` (the error from the other side), ``flip``, ``coverage``, ``dirichlet``, ``seconds``.
    arrays : dict of str to ndarray
        ``curve``: the share of points with at most each error of `CURVE`.
    """

    row: dict[str, Any]
    arrays: dict[str, np.ndarray]


def measured(
    one: Mesh,
    other: Mesh,
    truth: IntArray,
    other_truth: IntArray,
    other_mirrored: IntArray | None,
    matcher: str,
    samples: int,
    exact: bool,
) -> Measured:
    """Match a mesh with another, and measure the match at points whose truth is known.

    Parameters
    ----------
    one, other : Mesh
        The meshes, as they come.
    truth, other_truth : (k,) ndarray of int
        Vertices that correspond.
    other_mirrored : (k,) ndarray of int or None
        The same on the other side of the other mesh.
    matcher : str
        Name of the method of matching.
    samples : int
        Number of these vertices to measure at, evenly chosen; 0 for all.
    exact : bool
        As in `distances_to`.

    Returns
    -------
    Measured
        The figures.

    Raises
    ------
    CanonicalFormError
        If a mesh cannot be matched.
    """
    with one_thread():
        began = time.perf_counter()
        found = MATCHERS[matcher].match(one, other)
        seconds = time.perf_counter() - began
        places = np.einsum("ij,ijk->ik", found.weights, other.vertices[found.corners])
        count = len(truth)
        some = np.arange(count) if not 0 < samples < count else np.linspace(0, count - 1, samples).round().astype(int)
        nearest = nearest_corners(other, found.corners, places)
        there, vertices = places[truth[some]], other.vertices[nearest[truth[some]]]
        errors, points = distances_to(other, other_truth[some], [vertices, there], exact)
        apart = None
        if other_mirrored is not None:
            (apart,) = distances_to(other, other_mirrored[some], [vertices], exact)
    row = {
        "error": float(errors.mean()),
        "points": float(points.mean()),
        "mirrored": None if apart is None else float(apart.mean()),
        "flip": None if apart is None else bool(apart.mean() < errors.mean()),
        "coverage": coverage(other, nearest),
        "dirichlet": dirichlet_energy(one, other, places),
        "seconds": seconds,
    }
    return Measured(row, {"curve": (errors[None] <= CURVE[:, None]).mean(axis=1)})


def nearest_corners(mesh: Mesh, corners: IntArray, places: FloatArray) -> IntArray:
    """Return for each place on a triangle the corner that is nearest to it, (n,).

    The nearest vertex in space may be of other skin, where that touches or passes through.

    Parameters
    ----------
    mesh : Mesh
        The mesh that the places are on.
    corners : (n, 3) ndarray of int
        The corners of their triangles.
    places : (n, 3) ndarray of float
        The places.

    Returns
    -------
    (n,) ndarray of int
        Vertices of the mesh.
    """
    nearest = np.linalg.norm(mesh.vertices[corners] - places[:, None], axis=2).argmin(axis=1)
    return np.asarray(np.take_along_axis(corners, nearest[:, None], axis=1)[:, 0])


def coverage(mesh: Mesh, vertices: IntArray) -> float:
    """Return the share of a mesh's area whose vertices a match hits.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    vertices : (n,) ndarray of int
        Those that are hit.

    Returns
    -------
    float
        From 0 to 1.
    """
    areas = vertex_areas(*mesh)
    return float(areas[np.unique(vertices)].sum() / areas.sum())


def dirichlet_energy(one: Mesh, other: Mesh, places: FloatArray) -> float:
    """Return how much a match stretches: 1 for an isometry, more for a map that is not smooth.

    Parameters
    ----------
    one, other : Mesh
        The meshes.
    places : (n, 3) ndarray of float
        Where the vertices of the first lie on the other.

    Returns
    -------
    float
        ½ ∫ |∇f|² over the area of the other mesh.
    """
    energy = 0.5 * float(np.sum(places * (stiffness(triangulated(*one)) @ places)))
    return energy / float(surface_area(*other))
