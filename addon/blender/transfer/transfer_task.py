"""Transfers data from another object: read, matched without Blender, written."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError, InvalidMeshError, TooLargeError
from ...core.matching.seam_sides import SeamSides
from ...core.numerics.arrays import FloatArray, IntArray
from ..objects.body_points import with_points
from ..objects.combining import concatenated, moved, outward, require_thick, touching
from ..objects.marked_contacts import with_marks
from ..records.record import read_record
from ..words.advice import all_advised
from ..words.wording import listed, progress_of, told
from .donor import read_donor
from .transfer_item import TransferItem

if TYPE_CHECKING:
    from ...core import Match, Settings
    from ...core.run.monitor import Cancelled, Progress

TRANSFERS = ("GROUPS", "UVS", "COLOURS", "KEYS", "MATERIALS")
_OF_RIGS = ("stance_parts", "stance_strained")  # what speaks against a rig, and not against a match
_FEW = 5  # bones that hold skin: a trunk and four limbs; fewer do not tell how a body is posed
_LIKE_SIZED = 1.25  # size ratio of a body and the rig's own, either way, above which the rig hardly fits


class _Found(NamedTuple):
    """The points of the donor that a body has."""

    match: Match
    rest: FloatArray | None  # positions in the rest pose of the donor's rig, in world space
    weights: dict[str, FloatArray]  # of the donor's bones, by name, as its skeleton tells them


class TransferTask:
    """The transfer of data to objects from another. Objects that touch are matched as one body.

    The constructor reads all objects, `compute` may run in any thread, and `write` writes.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, accepted by `refusal`, at least one.
    source : bpy.types.Object or None
        The object to transfer from: a mesh, or an armature for all its meshes.
    kinds : set of str
        Kinds of data to transfer, from `TRANSFERS`.
    settings : Settings
        Options for all forms.
    side : int
        Which way to match: -1 for the most likely, or its index.
    anyway : bool
        Transfer from what is unlikely to fit, too.

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
        *,
        anyway: bool = False,
    ) -> None:
        self._donor = read_donor(source, objects)
        self._source = self._donor.data
        own = [obj.data for obj in self._donor.objects]
        first = {obj.data: obj for obj in reversed(objects) if obj.data not in own}  # of objects that share a mesh
        objects = list(reversed(first.values()))
        if not objects:
            raise CanonicalFormError(
                told("{name} is the reference itself. Select the mesh that is to take over.", name=self._source.name)
            )
        if not kinds:
            raise CanonicalFormError(told("Nothing is chosen to be transferred."))
        self._items = [TransferItem(obj) for obj in objects]
        for item in self._items:
            require_thick(item.reading.name, item.reading.placement, alone=len(objects) == 1)
        self._kinds, self._settings, self._side, self._anyway = kinds, settings, side, anyway
        self._rigged = "GROUPS" in kinds and bool(self._source.armature)
        self.warnings = list(self._donor.warnings)
        if self._source.damaged:
            self.warnings.append(
                told(
                    "{damaged} of {source} have values that are not numbers, and were left out.",
                    damaged=listed(self._source.damaged),
                    source=self._source.name,
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
        armature = self._donor.armature() if self._rigged else None
        for item in self._items:
            item.write(self._source, armature)
            self.warnings += item.warnings
            self.told += [each for each in item.told if each not in self.told]

    def _carry_to(self, items: list[TransferItem], progress: Progress | None, cancelled: Cancelled | None) -> None:
        """Match the objects of one body and transfer the data to them."""
        readings = [item.reading for item in items]
        placed, faces, starts = concatenated(
            [(moved(each.vertices, each.placement), outward(each.faces, each.placement)) for each in readings]
        )
        name = items[0].reading.name
        try:
            settings = with_marks(self._settings, [item.marks for item in items], starts.tolist())
            settings = with_points(settings, [item.points for item in items], starts.tolist())
            found = self._brought_together(placed, faces, settings, progress, cancelled)
        except MemoryError as error:
            raise TooLargeError(
                told("Not enough memory for {name}. Close other files, or decimate the mesh.", name=name)
            ) from error
        if found.rest is not None:
            self._warn_of_size(name, placed, faces)
        self.warnings += all_advised([*found.match.warnings, *found.match.other_warnings])
        keys = self._changed(placed, faces, found)
        for item, (start, end) in zip(items, pairwise(starts.tolist()), strict=True):
            back = np.linalg.inv(item.reading.placement)
            item.carry(
                _part(found.match, start, end),
                self._source,
                self._donor.vertices,
                self._kinds,
                {group: weights[start:end] for group, weights in found.weights.items()},
                {key: moved(shape[start:end], back) for key, shape in keys.items()},
                None if found.rest is None else moved(found.rest[start:end], back),
            )

    def _brought_together(
        self,
        placed: FloatArray,
        faces: IntArray,
        settings: Settings,
        progress: Progress | None,
        cancelled: Cancelled | None,
    ) -> _Found:
        """Find the points of the donor: by its skeleton if it has one, which explains more than a match alone."""
        from ...core import match, pose_like, require_fit, rig

        there, there_faces, bones = self._donor.vertices, self._donor.faces, self._donor.rig
        if bones is not None and self._side < 0 and bones.weights.any(axis=0).sum() >= _FEW:
            try:
                fitted = rig(
                    placed,
                    faces,
                    bones,
                    settings,
                    pose="rest" if self._rigged else None,
                    equal=False,
                    anyway=self._anyway,
                    progress=progress,
                    cancelled=cancelled,
                )
            except InvalidMeshError as error:
                if error.kind not in _OF_RIGS:
                    raise
            else:
                found = replace(fitted.match, warnings=fitted.warnings)
                rest = _in_the_rig(fitted.vertices, found, there) if self._rigged else None
                return _Found(found, rest, dict(zip(fitted.skeleton.names, fitted.weights.T, strict=True)))
        side: str | int = "auto" if self._side < 0 else self._side
        rest = None
        if self._rigged:
            posed = pose_like(
                placed, faces, there, there_faces, settings, side=side, progress=progress, cancelled=cancelled
            )
            found = posed.match
            rest = _in_the_rig(posed.vertices, found, there)
        else:
            found = match(
                placed, faces, there, there_faces, settings, side=side, progress=progress, cancelled=cancelled
            )
        if not self._anyway and self._side < 0:  # a side that was chosen has been looked at
            require_fit(found, placed, faces)
        return _Found(found, rest, {})

    def _changed(self, placed: FloatArray, faces: IntArray, found: _Found) -> dict[str, FloatArray]:
        """Apply the source's shape keys to a body, in the rig's rest pose if there is a rig, in world space."""
        from ...core import transferred_shape

        start = placed if found.rest is None else found.rest
        return {
            each.name: placed + transferred_shape(found.match, start, faces, self._donor.vertices, each.shape) - start
            for each in (self._source.keys if "KEYS" in self._kinds else ())
        }

    def _warn_of_size(self, name: str, placed: FloatArray, faces: IntArray) -> None:
        """Warn if a body is too large or too small for the rig."""
        from ...core.mesh.geometry import surface_area

        areas = surface_area(placed, faces), surface_area(self._donor.vertices, self._donor.faces)
        times = float(np.sqrt(areas[0] / areas[1]))
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
        Index of the way to match; -1 if the object is not in that pose, or matched in the likeliest way.
    """
    record = read_record(obj.data)
    like = None if record is None else record.report.like
    chosen = like is not None and like.side > 0 and (like.pose, like.name) == ("OBJECT", source)
    return like.side if like is not None and chosen else -1
