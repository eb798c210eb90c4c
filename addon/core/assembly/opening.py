"""Opens a mesh: finds its bodies, or reuses known ones, and rejects what does not fit into memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..method_api.costs import require_memory
from ..method_api.settings import Settings
from ..run.monitor import Monitor, Plan
from .bodies import Bodies, bodies_of
from .rest_pose import bodies_at_rest

OPENING: Plan = {"Surface": 2, "Pieces": 98}  # stages


def opened(
    vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor, *, rest: ArrayLike | None = None
) -> Bodies:
    """Find the bodies in a mesh, reject what does not fit into memory, and report repairs.

    `settings`: options of the method; `rest` (n, 3): positions in the rest pose of a rig.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> len(opened(tetrahedron, faces, Settings(), Monitor(plan=OPENING)).bodies)
    1
    """
    with monitor.stage("Surface"):
        features, names = settings.feature_points, settings.feature_names
        bodies = known_bodies(
            vertices, faces, monitor, together=settings.together, features=features, names=names, rest=rest
        )
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
    names: Sequence[str] | None = None,
    rest: ArrayLike | None = None,
) -> Bodies:
    """Find the bodies in a mesh, unless they are known from an earlier run.

    Examples
    --------
    >>> len(known_bodies([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], Monitor()).bodies)
    1
    """

    def found() -> Bodies:
        own = np.array(vertices) if monitor.keeps and isinstance(vertices, np.ndarray) else vertices
        corners = np.array(faces) if monitor.keeps and isinstance(faces, np.ndarray) else faces
        how: dict[str, Any] = {"together": together, "features": features, "names": names}
        if rest is None:
            return bodies_of(own, corners, monitor, **how)
        resting = np.array(rest) if monitor.keeps else rest
        return bodies_at_rest(own, corners, resting, monitor, **how)

    return monitor.kept("bodies", [vertices, faces, together, features, names, rest], found)
