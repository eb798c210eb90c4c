"""What a worker does: it matches one pair of poses, and measures how far each match is from the truth."""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np

from ...core.distances.heat import HeatMethod
from ...core.measures.crossings import crossings
from ...core.mesh.closest_points import closest_points
from ...core.mesh.coarsening import coarsened
from ...core.mesh.geometry import surface_area
from ...core.numerics.arrays import FloatArray
from ...core.surface.triangulation import triangulated
from ..tables import mean_apart
from ..work import one_thread
from .matchers import MATCHERS, Mesh

LEFT = 0.7  # share of the vertices of the other mesh that are kept
NEAR, NEARER = 0.10, 0.05  # sqrt(area), of the columns
FLIPPED, WRONG = 0.1, 0.3  # share of the vertices that are as far off (in sqrt(area)) where sides were swapped
APART = 0.1  # sqrt(area): poses that differ by less say nothing of a pose taken over
_SAMPLES = 300  # vertices at which a match is measured


class Outcome(NamedTuple):
    """What came of one pair and one way to match.

    Attributes
    ----------
    row : dict
        ``error``, ``near``, ``nearer``, ``flip``, ``seconds``; where a pose was taken over ``pose``, ``edges`` and how
        many pairs of triangles cross: ``crossings``, and ``_before`` in its own and ``_true`` in the true pose.
    arrays : dict of str to ndarray
        ``corners``, ``weights``, ``posed``.
    """

    row: dict[str, Any]
    arrays: dict[str, np.ndarray]


def remeshed(mesh: Mesh) -> Mesh:
    """Reduce a mesh and shuffle its vertices, always in the same way.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    Mesh
        Its remeshed twin: the surface is the same, the triangles are others.
    """
    coarse = coarsened(mesh.vertices, mesh.faces, int(LEFT * len(mesh.vertices)))
    rng = np.random.default_rng(1)
    order = rng.permutation(len(coarse.kept))
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    faces = number[coarse.faces]
    return Mesh(mesh.vertices[coarse.kept][order], faces[rng.permutation(len(faces))])


def matched(one: Mesh, other: Mesh, matcher: str, same_body: bool) -> Outcome:
    """Match a mesh with another pose of it, remeshed, and measure the match.

    Parameters
    ----------
    one, other : Mesh
        The poses, with the same vertices.
    matcher : str
        Name of the way to match.
    same_body : bool
        Whether they are poses of one body, so that the other is what a pose taken over should be.

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
    """Measure how far points on a mesh are from the vertices of the same numbers.

    Parameters
    ----------
    places : (n, 3) ndarray of float
        A point on the mesh, or close to it, for each vertex.
    mesh : Mesh
        The mesh, connected.
    samples : int
        Number of vertices at which that is measured, chosen at random, always the same.

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
    heat = HeatMethod(triangulated(*mesh), refine=False)
    found = closest_points(*mesh, places[some])
    at = np.take_along_axis(heat.distances(some).T, mesh.faces[found.faces], axis=1)
    return np.asarray(np.einsum("ij,ij->i", found.weights, at) / np.sqrt(surface_area(*mesh)))
