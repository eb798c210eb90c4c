"""The door to feature points and patches alone."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .assembly.bodies import Chosen, bodies_of
from .assembly.body import Body
from .method_api.catalogue import method_named
from .method_api.costs import require_memory
from .method_api.settings import Settings
from .method_api.surface_features import DETECTION, detected
from .numerics.arrays import FloatArray, IntArray
from .results import FeaturePatches
from .run.monitor import Cancelled, Monitor, Plan, Progress

OPENING: Plan = {"Surface": 2, "Pieces": 98}  # the stages of every door


def feature_patches(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    *,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> FeaturePatches:
    """Find the feature points and patches of a mesh, and stop there.

    Parameters
    ----------
    vertices, faces, settings, progress, cancelled
        As in `canonical_form`.

    Returns
    -------
    FeaturePatches
        The same that `canonical_form` finds.

    Raises
    ------
    CanonicalFormError
        As `canonical_form` does.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> found = feature_patches(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> len(found.patches), len(found.feature_points) > 0
    (4, True)

    References
    ----------
    The paper, sections 3.1 and 3.2.
    """
    settings = settings or Settings()
    settings = method_named(settings.method).settings(settings)
    monitor = Monitor(progress, cancelled, OPENING)
    with monitor.stage("Surface"):
        bodies = bodies_of(vertices, faces, monitor, together=settings.together, features=settings.feature_points)
        require_memory(bodies.largest, settings)
    monitor.extend(bodies.pieces.repairs + bodies.apart)

    def work(body: Body, chosen: Chosen | None, own: Monitor) -> tuple[IntArray, IntArray, FloatArray]:
        given = None if chosen is None else chosen.vertices
        found = detected(body.points, body.faces, given, settings, own, reduced=body.working_surface)
        return found.prolonged(own)

    found = bodies.map(work, monitor, DETECTION, bodies.chosen)
    if bodies.detected_elsewhere:
        monitor.warn("features_detected_elsewhere", count=bodies.detected_elsewhere)
    return FeaturePatches(*bodies.gathered_features(found), monitor.timings, monitor.warnings)
