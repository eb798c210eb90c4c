"""The pose of one body of a task: by the bones of its own rig where they tell it, else by a match."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...core.mesh.geometry import vertex_areas
from ..objects.combining import Combined, moved, require_thick
from ..objects.mesh_reading import Bones, Reading
from ..objects.placement import world_rotation
from .parted_result import turned

if TYPE_CHECKING:
    from ...core import KeptStages, Settings
    from ...core.results import Shaped
    from ...core.run.monitor import Cancelled, Progress
    from ..results.match_values import MatchValues
    from .likeness import Likeness


def posed_like(
    readings: Sequence[Reading],
    whole: Combined,
    likeness: Likeness,
    settings: Settings,
    progress: Progress | None,
    cancelled: Cancelled | None,
    keep: KeptStages | None = None,
) -> tuple[Shaped, MatchValues | None]:
    """Put objects into a pose, oriented as in the scene; does not access Blender's data.

    Parameters
    ----------
    readings : sequence of Reading
        The objects.
    whole : Combined
        The same objects as one mesh, without mirror images.
    likeness : Likeness
        The pose.
    settings : Settings
        Options of a match.
    progress, cancelled : callable, optional
        As in `canonical_form`.
    keep : KeptStages, optional
        Results of earlier runs on these objects.

    Returns
    -------
    found : PosedLike or Stance
        The objects in that pose, in the space of the combined mesh.
    carried : MatchValues or None
        Values that show the match; None where bones told the pose.

    Raises
    ------
    CanonicalFormError
        As in `pose_like`.
    """
    alone = len(readings) == 1
    bones = _common_bones(readings, whole) if likeness.by_bones else None
    if bones is not None:
        place = readings[0].placement if alone else np.eye(4)  # several objects are in world space
        if alone:
            require_thick(readings[0].name, place, alone=True)
        rest, shown = moved(bones.rest, place), moved(whole.vertices, place)
        stance = likeness.stance(rest, whole.faces, bones)
        if stance is not None:
            areas = [vertex_areas(points, whole.faces) for points in (rest, shown)]
            way = areas[1] / areas[1].sum() @ shown - areas[0] / areas[0].sum() @ rest  # from where it rests
            return replace(stance, vertices=moved(stance.vertices + way, np.linalg.inv(place))), None
    turn = world_rotation(readings[0].placement) if alone else np.eye(3)
    found, carried = likeness.posed(
        whole.vertices @ turn.T, whole.faces, settings, whole.rest, progress, cancelled, keep
    )
    return turned(found, turn), carried


def _common_bones(readings: Sequence[Reading], whole: Combined) -> Bones | None:
    """Return the bones of all vertices, if one armature moves all objects."""
    found = [each.bones for each in readings if each.bones is not None]
    if not found or len(found) < len(readings) or len({each.rig for each in found}) > 1:
        return None
    rest = whole.put_together([each.rest for each in found])
    return found[0]._replace(weights=np.concatenate([each.weights for each in found]), rest=rest)
