"""The task of a worker: match one pair of poses, and measure the errors of the match."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ...core.distances.heat import HeatMethod
from ...core.measures.crossings import crossings
from ...core.mesh.closest_points import closest_points
from ...core.mesh.geometry import surface_area
from ...core.numerics.arrays import FloatArray, IntArray
from ...core.surface.delaunay import intrinsic_delaunay
from ...core.surface.triangulation import triangulated
from ..remeshing import thinned
from ..tables import mean_apart
from ..work import one_thread
from .matchers import MATCHERS, Mesh

NEAR, NEARER = 0.10, 0.05  # sqrt(area), error bounds of the columns
FLIPPED, WRONG = 0.1, 0.3  # sides count as swapped if this share of the vertices has a larger error (in sqrt(area))
APART = 0.1  # sqrt(area): poses that differ by less cannot show whether a pose was transferred
_SAMPLES = 300  # vertices at which a match is measured


class Outcome(NamedTuple):
    """Result of one pair and one method of matching.

    Attributes
    ----------
    row : dict
        ``error``, ``near``, ``nearer``, ``flip``, ``seconds``; with a transferred pose also ``pose``, ``edges`` and how
        many pairs of triangles cross: ``crossings``, and ``_before`` in its own and ``_true`` in the true pose.
    arrays : dict of str to ndarray
        ``corners``, ``weights``, ``posed``.
    """

    row: dict[str, Any]
    arrays: dict[str, np.ndarray]


def remeshed(mesh: Mesh) -> Mesh:
    """Reduce a mesh and shuffle its vertices, deterministically.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    Mesh
        A remeshed copy: the same surface with other triangles.
    """
    rows, faces = thinned(*mesh)
    return Mesh(mesh.vertices[rows], faces)


def matched(one: Mesh, other: Mesh, matcher: str, same_body: bool) -> Outcome:
    """Match a mesh with another, remeshed pose of it, and measure the match.

    Parameters
    ----------
    one, other : Mesh
        The poses, with the same vertices.
    matcher : str
        Name of the method of matching.
    same_body : bool
        Whether both are poses of one body, so that the transferred pose should equal the other mesh.

    Returns
    -------
    Outcome
        The figures.

    Raises
    ------
    CanonicalFormError
        If a mesh cannot be matched.
    """
    reference = remeshed(other)
    with one_thread():
        began = time.perf_counter()
        found = MATCHERS[matcher].match(one, reference)
        seconds = time.perf_counter() - began
        places = np.einsum("ij,ijk->ik", found.weights, reference.vertices[found.corners])
        errors = geodesic_errors(places, other)
    row = {
        "error": float(errors.mean()),
        "nearer": float((errors < NEARER).mean()),
        "near": float((errors < NEAR).mean()),
        "flip": bool((errors > WRONG).mean() > FLIPPED),
        "pose": None,
        "edges": found.edges,
        "crossings": None,
        "crossings_before": None,
        "crossings_true": None,
        "seconds": seconds,
    }
    arrays = {"corners": found.corners.astype(np.int32), "weights": found.weights.astype(np.float32)}
    if found.posed is not None:
        arrays["posed"] = found.posed.astype(np.float32)
        apart = mean_apart([one.vertices, other.vertices])
        if same_body and apart > APART * np.sqrt(surface_area(*one)):
            row["pose"] = mean_apart([found.posed, other.vertices]) / apart
        shapes = {"crossings": found.posed, "crossings_before": one.vertices, "crossings_true": other.vertices}
        for name, shape in shapes.items():
            if same_body or name != "crossings_true":
                row[name] = len(crossings(shape, one.faces))
    return Outcome(row, arrays)


def geodesic_errors(places: FloatArray, mesh: Mesh, samples: int = _SAMPLES) -> FloatArray:
    """Measure how far points on a mesh are from the vertices with the same indices.

    Parameters
    ----------
    places : (n, 3) ndarray of float
        A point on the mesh, or close to it, for each vertex.
    mesh : Mesh
        The mesh, connected.
    samples : int
        Number of vertices to measure, chosen at random with a fixed seed.

    Returns
    -------
    (samples,) ndarray of float
        Geodesic distances in units of sqrt(area).

    Raises
    ------
    SolverError
        If the mesh is not connected.
    """
    count = len(mesh.vertices)
    some = np.random.default_rng(1).choice(count, min(samples, count), replace=False)
    return distances_to(mesh, some, [places[some]], exact=False)[0]


def distances_to(mesh: Mesh, sources: IntArray, places: Sequence[FloatArray], exact: bool) -> list[FloatArray]:
    """Measure how far each of some places on a mesh is from a vertex of its own.

    Parameters
    ----------
    mesh : Mesh
        The mesh, connected.
    sources : (s,) ndarray of int
        The vertices.
    places : sequence of (s, 3) ndarray of float
        The places, on the mesh or close to it; several for each vertex.
    exact : bool
        Whether distances are exact, by pygeodesic, or of the heat method, which is faster and blurs small ones.

    Returns
    -------
    list of (s,) ndarray of float
        Geodesic distances in units of sqrt(area), for each of `places`.

    Raises
    ------
    SolverError
        If the mesh is not connected.
    """
    if exact:
        from pygeodesic.geodesic import PyGeodesicAlgorithmExact

        algorithm = PyGeodesicAlgorithmExact(mesh.vertices, mesh.faces)
        fields = np.array([algorithm.geodesicDistances([source], None)[0] for source in sources])
    else:
        fields = HeatMethod(intrinsic_delaunay(triangulated(*mesh))).distances(sources).T
    measured_at = []
    for each in places:
        found = closest_points(*mesh, each)
        at = np.take_along_axis(fields, mesh.faces[found.faces], axis=1)
        measured_at.append(np.einsum("ij,ij->i", found.weights, at) / np.sqrt(surface_area(*mesh)))
    return measured_at
