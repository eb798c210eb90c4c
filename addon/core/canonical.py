"""The whole way from a mesh to its canonical form, step by step in the order of the paper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .alignment import rigid_fit
from .local_features import local_feature_form
from .monitor import Cancelled, Monitor, Progress
from .recognition import recognised
from .settings import Settings
from .surface import FloatArray, IntArray, surface_area, vertex_areas


@dataclass(frozen=True, eq=False)
class CanonicalForm:
    """The canonical form of a mesh and what was found on the way.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The form: the input's area, rigidly aligned to the input.
    feature_points : (k,) ndarray of int
        Vertices, most prominent first.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to.
    adf : (n,) ndarray of float
        Auto Diffusion Function of the surface scaled to unit area.
    stress : (s + 1,) ndarray of float
        Equation 10 before each of the s steps and after the last, of the surface scaled to unit area.
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
        Triangles of one connected surface, with or without borders.
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
        If a feature point given by hand is not a vertex, or is given twice.
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If `cancelled` returned True.
    """
    settings = settings or Settings()
    monitor = Monitor(progress, cancelled)
    found = recognised(vertices, faces, settings, monitor)
    if settings.method == "local_features":
        embedded = local_feature_form(found, settings, monitor)
    else:
        from .rivals.choice import rival_form

        embedded = rival_form(found, settings, monitor)
    with monitor.stage("Alignment", 1.0):
        features, cells, adf = found.carried_back(monitor)
        form = embedded.points / np.sqrt(surface_area(embedded.points, found.whole_triangles))
        areas = vertex_areas(found.whole_points, found.whole_triangles)
        rotation, shift = rigid_fit(form, found.whole_points, areas)
        form = (form @ rotation + shift) * found.unit + found.centre
    return CanonicalForm(
        form,
        features,
        cells,
        adf,
        embedded.history,
        embedded.pair_count,
        1 - embedded.pair_count / len(found.whole_points) ** 2,
        monitor.timings,
        monitor.warnings,
    )
