"""What the doors to features and forms share: finding the bodies of a mesh, the features of one, limbs told apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .assembly.bodies import Bodies, Chosen, bodies_of
from .assembly.body import Body
from .method_api.costs import require_memory
from .method_api.settings import Settings
from .method_api.surface_features import SurfaceFeatures, detected
from .numerics.arrays import FloatArray, IntArray
from .results import BodyLimbs
from .run.monitor import Monitor, Plan
from .symmetry.limbs import Limbs

Found = tuple[IntArray, IntArray, FloatArray]  # feature points, cells and ADF of a body, on its vertices

OPENING: Plan = {"Surface": 2, "Pieces": 98}  # stages


def opened(vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor) -> Bodies:
    """Find the bodies in a mesh, refuse what does not fit into memory, and tell what was done to the mesh.

    Parameters
    ----------
    vertices, faces
        As in `canonical_form`.
    settings : Settings
        Options of the method.
    monitor : Monitor
        Of the whole run, with the stages `OPENING`; receives warnings.

    Returns
    -------
    Bodies
        The bodies.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point given by hand is not a vertex of a surface, or is given twice.
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> len(opened(tetrahedron, faces, Settings(), Monitor(plan=OPENING)).bodies)
    1
    """
    with monitor.stage("Surface"):
        bodies = known_bodies(vertices, faces, monitor, together=settings.together, features=settings.feature_points)
        require_memory(bodies.largest, settings)
    monitor.extend(bodies.pieces.repairs + bodies.apart)
    if bodies.detected_elsewhere:
        monitor.warn("features_detected_elsewhere", count=bodies.detected_elsewhere)
    return bodies


def known_bodies(
    vertices: ArrayLike,
    faces: ArrayLike,
    monitor: Monitor,
    *,
    together: bool = True,
    features: Sequence[int] | None = None,
) -> Bodies:
    """Find the bodies in a mesh, unless they are known from an earlier run.

    Parameters
    ----------
    vertices, faces, together, features
        As in `bodies_of`.
    monitor : Monitor
        Knows what is kept; polled for cancellation.

    Returns
    -------
    Bodies
        The bodies. Those that are kept have arrays of their own, which the caller may not change.

    Raises
    ------
    InvalidMeshError, InvalidSettingsError, CancelledError
        As `bodies_of` does.

    Examples
    --------
    >>> len(known_bodies([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], Monitor()).bodies)
    1
    """

    def found() -> Bodies:
        own = np.array(vertices) if monitor.keeps and isinstance(vertices, np.ndarray) else vertices
        corners = np.array(faces) if monitor.keeps and isinstance(faces, np.ndarray) else faces
        return bodies_of(own, corners, monitor, together=together, features=features)

    return monitor.kept("bodies", [vertices, faces, together, features], found)


def features_of(body: Body, chosen: Chosen | None, settings: Settings, monitor: Monitor) -> SurfaceFeatures:
    """Find the feature points and patches of a body.

    Parameters
    ----------
    body : Body
        The body.
    chosen : Chosen or None
        Its feature points, where they are chosen by hand.
    settings : Settings
        Options of the method.
    monitor : Monitor
        With the stages `DETECTION`; receives warnings.

    Returns
    -------
    SurfaceFeatures
        What was found.

    Raises
    ------
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> from addon.core.method_api.surface_features import DETECTION
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> body = bodies_of(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).bodies[0]
    >>> features_of(body, None, Settings(), Monitor(plan=DETECTION)).cells.shape
    (4,)
    """
    given = None if chosen is None else chosen.vertices
    return detected(body.points, body.faces, given, settings, monitor, reduced=body.working_surface)


def body_limbs(bodies: Bodies, found: Sequence[Found], limbs: Sequence[Limbs]) -> list[BodyLimbs]:
    """Tell what tells the feature points of each body apart, in terms of the whole mesh.

    Parameters
    ----------
    bodies : Bodies
        The bodies.
    found : sequence of tuple
        Feature points, cells and Auto Diffusion Function of each, on its vertices.
    limbs : sequence of Limbs
        What tells its feature points apart.

    Returns
    -------
    list of BodyLimbs
        One per body.

    Examples
    --------
    >>> from addon.core import feature_patches
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> found = feature_patches(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> found.bodies[0].vertices.tolist()
    [0, 1, 2, 3]
    """
    numbers = bodies.feature_numbers([features for features, *_ in found])
    return [
        BodyLimbs(body.vertices, features, own, each)
        for body, (features, *_), own, each in zip(bodies.bodies, found, numbers, limbs, strict=True)
    ]
