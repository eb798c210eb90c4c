"""The door to feature points and patches alone."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .assembly.bodies import Chosen
from .assembly.body import Body
from .method_api.catalogue import method_named
from .method_api.settings import Settings
from .method_api.surface_features import DETECTION
from .opening import OPENING, Found, body_limbs, features_of, opened
from .results import FeaturePatches
from .run.monitor import Cancelled, Monitor, Progress
from .symmetry.limbs import Limbs


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
    bodies = opened(vertices, faces, settings, monitor)

    def work(body: Body, chosen: Chosen | None, own: Monitor) -> tuple[Found, Limbs]:
        found = features_of(body, chosen, settings, own)
        return found.prolonged(own), found.limbs

    results = bodies.map(work, monitor, DETECTION, bodies.chosen)
    found_on_each = [found for found, _ in results]
    return FeaturePatches(
        *bodies.gathered_features(found_on_each),
        monitor.timings,
        monitor.warnings,
        body_limbs(bodies, found_on_each, [limbs for _, limbs in results]),
    )
