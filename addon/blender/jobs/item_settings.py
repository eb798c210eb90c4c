"""Options of a run on several objects as one mesh: points and marks of each by their numbers there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...core import Settings
from ..objects.body_points import BodyPoints
from ..objects.combining import Combined
from ..objects.marked_contacts import Marks, all_marks


def settings_on(whole: Combined, settings: Settings, chosen: Sequence[BodyPoints], marks: Sequence[Marks]) -> Settings:
    """Give chosen points and marks of objects their numbers on the combined mesh.

    Parameters
    ----------
    whole : Combined
        The objects as one mesh, with mirror images.
    settings : Settings
        The options; their marks are those of the first object.
    chosen : sequence of BodyPoints
        Feature points on each object.
    marks : sequence of Marks
        Marks on each object.

    Returns
    -------
    Settings
        The options on the combined mesh.

    Raises
    ------
    InvalidSettingsError
        If a vertex does not exist on its object.
    """
    if any(each.vertices for each in chosen):
        vertices, names = whole.points_of(chosen)
        settings = replace(settings, feature_points=vertices, feature_names=names)
    part_here, keep_joined = zip(*all_marks(settings, marks), strict=True)
    return replace(
        settings,
        part_here=whole.numbers_of(part_here, "part_here"),
        keep_joined=whole.numbers_of(keep_joined, "keep_joined"),
    )
