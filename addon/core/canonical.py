"""The main door: from a mesh to its canonical form, in the order of the paper."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .assembly.bodies import Chosen
from .assembly.body import Body
from .measures.alignment import rigid_fit
from .mesh.geometry import surface_area, vertex_areas
from .method_api.catalogue import method_named
from .method_api.method_result import MethodResult
from .method_api.settings import Settings
from .method_api.surface_features import DETECTION, SurfaceFeatures
from .numerics.arrays import FloatArray, IntArray
from .opening import OPENING, features_of, opened
from .results import CanonicalForm
from .run.monitor import Cancelled, Monitor, Progress

Found = tuple[IntArray, IntArray, FloatArray]  # feature points, cells and ADF of a piece


def canonical_form(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    *,
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
        Polled at least twice a second; the computation stops when it returns True.

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

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> form = canonical_form(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> form.vertices.shape
    (4, 3)

    References
    ----------
    "Local Feature-Based 3D Canonical Form".
    """
    settings = settings or Settings()
    method = method_named(settings.method)
    settings = method.settings(settings)
    monitor = Monitor(progress, cancelled, OPENING)
    bodies = opened(vertices, faces, settings, monitor)

    def work(body: Body, chosen: Chosen | None, own: Monitor) -> tuple[Found, FloatArray, MethodResult]:
        found = features_of(body, chosen, settings, own)
        embedded = method.unfold(found, settings, own)
        with own.stage("Alignment"):
            return found.prolonged(own), _laid_onto_input(embedded.points, found), embedded

    plan = {**DETECTION, **method.stages, "Alignment": 1}
    results = bodies.map(work, monitor, plan, bodies.chosen)
    histories = [embedded.history for _, _, embedded in results]
    steps = max(map(len, histories))  # each stays at its end value once it has ended
    pair_count = sum(embedded.pair_count for _, _, embedded in results)
    return CanonicalForm(
        bodies.shaped([form for _, form, _ in results], monitor, area_kept=True),
        bodies.faces,
        *bodies.gathered_features([found for found, _, _ in results]),
        np.sum([np.pad(each, (0, steps - len(each)), mode="edge") for each in histories], axis=0),
        pair_count,
        1 - pair_count / len(bodies.vertices) ** 2,
        monitor.timings,
        monitor.warnings,
        float(np.fmax.reduce([embedded.asymmetry for _, _, embedded in results])),
    )


def _laid_onto_input(points: FloatArray, found: SurfaceFeatures) -> FloatArray:
    """Give a form the input's area and the proper rotation and place that fit the input best."""
    form = points / np.sqrt(surface_area(points, found.whole_faces))
    areas = vertex_areas(found.whole_points, found.whole_faces)
    rotation, shift = rigid_fit(form, found.whole_points, areas)
    return (form @ rotation + shift) * found.unit + found.centre
