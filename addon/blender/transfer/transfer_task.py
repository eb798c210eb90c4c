"""Transfers data from another object: read, matched without Blender, written."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError, TooLargeError
from ...core.matching.seam_sides import SeamSides
from ...core.numerics.arrays import FloatArray, IntArray
from ..jobs.pose_reading import reference_refusal
from ..objects.combining import moved, outward, require_thick, touching
from ..objects.mesh_reading import read_mesh
from ..objects.object_states import object_mode
from ..objects.placement import placement_of
from ..records.record import read_record
from ..words.advice import all_advised
from ..words.wording import listed, progress_of, told
from .transfer_item import TransferItem
from .transfer_reading import Source, read_source

if TYPE_CHECKING:
    from ...core import Match, Settings
    from ...core.run.monitor import Cancelled, Progress

TRANSFERS = ("GROUPS", "UVS", "COLOURS", "KEYS", "MATERIALS")
_LIKE_SIZED = 1.25  # size ratio of a body and the rig's own, either way, above which the rig hardly fits


class TransferTask:
    """The transfer of data to objects from another. Objects that touch are matched as one body.

    The constructor reads all objects, `compute` may run in any thread, and `write` writes.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, accepted by `refusal`, at least one.
    source : bpy.types.Object or None
        The object to transfer from.
    kinds : set of str
        Kinds of data to transfer, from `TRANSFERS`.
    settings : Settings
        Options for all forms.
    side : int
        Which way to match: -1 for the most likely, or its index.

    Attributes
    ----------
    warnings : list of str
        Sentences for the user.
    told : list of str
        Descriptions of the transferred data.

    Raises
    ------
    CanonicalFormError
        If there is nothing to transfer, or an object cannot be read.
    """

    def __init__(
        self,
        objects: Sequence[bpy.types.Object],
        source: bpy.types.Object | None,
        kinds: Set[str],
        settings: Settings,
        side: int,
    ) -> None:
        reason = reference_refusal(source)
        if source is None or reason is not None:
            raise CanonicalFormError(reason or "")
        first = {obj.data: obj for obj in reversed(objects) if obj.data != source.data}  # of objects that share a mesh
        objects = list(reversed(first.values()))
        if not objects:
            raise CanonicalFormError(
                told("{name} is the reference itself. Select the mesh that is to take over.", name=source.name)
            )
        if not kinds:
            raise CanonicalFormError(told("Nothing is chosen to be transferred."))
        self._items = [TransferItem(obj) for obj in objects]
        for item in self._items:
            require_thick(item.reading.name, item.reading.placement, alone=len(objects) == 1)
        with object_mode(source):
            self._there, self._there_faces = read_mesh(source.data)
            self._source: Source = read_source(source)
            self._there_placement = placement_of(source, False)
        require_thick(source.name, self._there_placement, alone=True)
        self._kinds, self._settings, self._side = kinds, settings, side
        self._rigged = "GROUPS" in kinds and bool(self._source.armature)
        self.warnings: list[str] = []
        if self._source.damaged:
            self.warnings.append(
                told(
                    "{damaged} of {source} have values that are not numbers, and were left out.",
                    damaged=listed(self._source.damaged),
                    source=source.name,
                )
            )
        self.told: list[str] = []

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Match the bodies and transfer the data; does not access Blender's data.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `match`.

        Raises
        ------
        CanonicalFormError
            If a mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        readings = [item.reading for item in self._items]
        groups = [[0]]
        if len(readings) > 1:
            groups = touching(readings, together=self._settings.together, cancelled=cancelled)
        for number, group in enumerate(groups):
            items = [self._items[index] for index in group]
            self._carry_to(items, progress_of(progress, items[0].reading.name, number, len(groups)), cancelled)

    def write(self) -> None:
        """Write the transferred data, in the main thread.

        Raises
        ------
        CanonicalFormError
            If an object was removed or changed; the message says why, and nothing was written.
        """
        for item in self._items:
            item.require_unchanged()
        for item in self._items:
            item.write(self._source)
            self.warnings += item.warnings
            self.told += [each for each in item.told if each not in self.told]

    def _carry_to(self, items: list[TransferItem], progress: Progress | None, cancelled: Cancelled | None) -> None:
        """Match the objects of one body and transfer the data to them."""
        from ...core import match, pose_like

        starts = np.cumsum([0, *(len(item.reading.vertices) for item in items)])
        parts = [_placed(each.reading.vertices, each.reading.faces, each.reading.placement) for each in items]
        placed = np.concatenate([points for points, _ in parts])
        faces = np.concatenate([own + start for (_, own), start in zip(parts, starts, strict=False)])
        there, there_faces = _placed(self._there, self._there_faces, self._there_placement)
        side = "auto" if self._side < 0 else self._side
        name = items[0].reading.name
        rest = None
        try:
            if self._rigged:
                posed = pose_like(
                    placed, faces, there, there_faces, self._settings, side=side, progress=progress, cancelled=cancelled
                )
                found = posed.match
                rest = _in_the_rig(posed.vertices, found, there)
                self._warn_of_size(name, placed, faces, there, there_faces)
            else:
                found = match(
                    placed, faces, there, there_faces, self._settings, side=side, progress=progress, cancelled=cancelled
                )
        except MemoryError as error:
            raise TooLargeError(
                told("Not enough memory for {name}. Close other files, or decimate the mesh.", name=name)
            ) from error
        self.warnings += all_advised([*found.warnings, *found.other_warnings])
        keys = self._changed(placed, faces, found, rest)
        for item, (start, end) in zip(items, pairwise(starts.tolist()), strict=True):
            back = np.linalg.inv(item.reading.placement)
            item.carry(
                _part(found, start, end),
                self._source,
                self._there,
                self._kinds,
                {key: moved(shape[start:end], back) for key, shape in keys.items()},
                None if rest is None else moved(rest[start:end], back),
            )

    def _changed(
        self, placed: FloatArray, faces: IntArray, found: Match, rest: FloatArray | None
    ) -> dict[str, FloatArray]:
        """Apply the source's shape keys to a body, in the rig's rest pose if there is a rig, in world space."""
        from ...core import transferred_shape

        start, there = placed if rest is None else rest, moved(self._there, self._there_placement)
        return {
            each.name: placed
            + transferred_shape(found, start, faces, there, moved(each.shape, self._there_placement))
            - start
            for each in (self._source.keys if "KEYS" in self._kinds else ())
        }

    def _warn_of_size(
        self, name: str, placed: FloatArray, faces: IntArray, there: FloatArray, there_faces: IntArray
    ) -> None:
        """Warn if a body is too large or too small for the rig."""
        from ...core.mesh.geometry import surface_area

        times = float(np.sqrt(surface_area(placed, faces) / surface_area(there, there_faces)))
        if not 1 / _LIKE_SIZED < times < _LIKE_SIZED:
            self.warnings.append(
                told(
                    "{name} is {times:.2g} times as large as {source}. Scale it first, for the rig to fit.",
                    name=name,
                    times=times,
                    source=self._source.name,
                )
            )


def _part(found: Match, start: int, end: int) -> Match:
    """Return the match of a range of vertices."""
    own = slice(start, end)
    seams = found.seams
    if seams is not None:
        vertices, faces, weights = seams.sides
        here = (vertices >= start) & (vertices < end)
        joined = seams.joined[own] - start  # copies in other objects are not at hand
        joined = np.where((joined >= 0) & (joined < end - start), joined, np.arange(end - start))
        seams = seams._replace(joined=joined, sides=SeamSides(vertices[here] - start, faces[here], weights[here]))
    return replace(
        found,
        seams=seams,
        vertices=found.vertices[own],
        faces=found.faces[own],
        weights=found.weights[own],
        confidence=found.confidence[own],
    )


def _in_the_rig(posed: FloatArray, found: Match, there: FloatArray) -> FloatArray:
    """Move a body in the rest pose to the position of the rig."""
    from ...core import transferred
    from ...core.measures.alignment import rigid_fit

    known = found.confidence > np.median(found.confidence) / 2
    rotation, shift = rigid_fit(posed[known], transferred(found, there)[known])
    return np.asarray(posed @ rotation + shift)


def _placed(points: FloatArray, faces: IntArray, placement: FloatArray) -> tuple[FloatArray, IntArray]:
    """Transform a mesh to world space, with normals that still point outward."""
    return moved(points, placement), outward(faces, placement)


def side_of(obj: bpy.types.Object, source: str) -> int:
    """Return the way in which an object was matched with another when it was put into its pose.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    source : str
        Name of the other object.

    Returns
    -------
    int
        Index of the way to match; -1 if the object is not in that pose.
    """
    record = read_record(obj.data)
    like = None if record is None else record.report.like
    return like.side if like is not None and (like.pose, like.name) == ("OBJECT", source) else -1
