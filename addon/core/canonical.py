"""The whole way from a mesh to its canonical form, step by step in the order of the paper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .assembly.parts import Part
from .measures.alignment import rigid_fit
from .mesh.geometry import surface_area, vertex_areas
from .methods.local_features import local_feature_form
from .numerics.arrays import FloatArray, IntArray
from .run.monitor import Cancelled, Monitor, Progress
from .unfolding.embedding import Embedding
from .unfolding.recognition import FeaturePatches, parts_to_work_on, recognised, together
from .unfolding.settings import Settings


@dataclass(frozen=True, eq=False)
class CanonicalForm:
    """The canonical form of a mesh and what was found on the way.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The form: the input's area, rigidly aligned to the input, each connected part by itself. Vertices of no face
        are where they were.
    faces : (m', 3) ndarray of int
        The triangles that it is the form of: those given, mended where the warnings say so.
    feature_points : (k,) ndarray of int
        Vertices, most prominent first, part by part, those of the largest first.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to; -1 for vertices of no face.
    adf : (n,) ndarray of float
        Auto Diffusion Function of each part scaled to unit area; 0 at vertices of no face.
    stress : (s + 1,) ndarray of float
        Equation 10 before each of the s steps and after the last, of the surface scaled to unit area; the sum over the
        parts.
    pair_count : int
        Entries of the distance matrices that the stress uses, counted as the paper does: Σ p² over the patches and
        the feature points. Each pair of points is kept once.
    pair_reduction : float
        ``1 - pair_count / n²``.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of str
        Sentences for the user.
    """

    vertices: FloatArray
    faces: IntArray
    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    stress: FloatArray
    pair_count: int
    pair_reduction: float
    timings: dict[str, float]
    warnings: list[str]


def canonical_form(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> CanonicalForm:
    """Compute the canonical form of a posed mesh: its shape with the pose taken out.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces, with or without borders, in any state that docs/any-mesh.md lists.
    settings : Settings, optional
        Options.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Asked at least twice a second; the computation stops when it returns True.

    Returns
    -------
    CanonicalForm
        The form, feature points, patches and figures.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point given by hand is not a vertex of a surface, or is given twice.
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If `cancelled` returned True.
    """
    settings = settings or Settings()
    monitor = Monitor(progress, cancelled)
    parts, given = parts_to_work_on(vertices, faces, settings, monitor)
    forms = []
    for (part, own), points in zip(parts.each(monitor), given, strict=True):
        forms.append(_form_of_part(part, None if points is None else points[1], settings, own))
    found = together(parts, [form[0] for form in forms], given, settings.feature_points, monitor)
    pair_count = sum(embedded.pair_count for _, _, embedded in forms)
    return CanonicalForm(
        parts.together([form for _, form, _ in forms], parts.vertices),
        parts.faces,
        found.feature_points,
        found.patches,
        found.adf,
        _summed([embedded.history for _, _, embedded in forms]),
        pair_count,
        1 - pair_count / len(parts.vertices) ** 2,
        monitor.timings,
        monitor.warnings,
    )


def _form_of_part(
    part: Part, given: IntArray | None, settings: Settings, monitor: Monitor
) -> tuple[FeaturePatches, FloatArray, Embedding]:
    """Find the form of one connected surface."""
    found = recognised(part.points, part.faces, given, settings, monitor)
    if settings.method == "local_features":
        embedded = local_feature_form(found, settings, monitor)
    else:
        from .unfolding.catalogue import rival_form

        embedded = rival_form(found, settings, monitor)
    with monitor.stage("Alignment", 1.0):
        patches = found.carried_back(monitor)
        form = embedded.points / np.sqrt(surface_area(embedded.points, found.whole_triangles))
        areas = vertex_areas(found.whole_points, found.whole_triangles)
        rotation, shift = rigid_fit(form, found.whole_points, areas)
        form = (form @ rotation + shift) * found.unit + found.centre
    return patches, form, embedded


def _summed(histories: list[FloatArray]) -> FloatArray:
    """Add courses of the stress, each at its end value once it has ended."""
    steps = max(len(each) for each in histories)
    return np.sum([np.pad(each, (0, steps - len(each)), mode="edge") for each in histories], axis=0)
