"""Gives objects that are one body an armature: read, computed without Blender, written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError, TooLargeError
from ...core.rigging.namings import named_as
from ...core.rigging.reference_rig import MANNEQUIN_BONES
from ..mesh_items.active_items import active_items, existing_items, restore_active_items
from ..mesh_items.fingerprints import group_fingerprints, key_fingerprint
from ..mesh_items.group_weights import fill_group, in_steps
from ..objects.body_points import points_by_hand, points_on, with_points
from ..objects.combining import concatenated, moved, outward, require_thick
from ..objects.marked_contacts import read_marks, with_marks
from ..objects.mesh_reading import Reading, find_object, read_object, require_unchanged
from ..objects.object_states import object_mode
from ..objects.rest_reading import rigs_of
from ..records.form_key import form_key
from ..records.rig_record import DOUBTFUL, SCAN, RigRecord, read_rig, write_rig
from ..results.in_betweens import PROPERTY, has_in_betweens
from ..words.advice import all_advised
from ..words.wording import listed, told
from .armatures import add_armature, add_pose, bone_matrices, colour_bones, follow
from .made_data import MARK, action_fingerprint, all_or_nothing, armature_fingerprint, new_token, unnumbered
from .rig_clearing import armature_given_to, release, unbind
from .rig_reading import RigSource, rolled
from .rigify import DEFORMING, add_rigify, add_rigify_pose, require_rigify

if TYPE_CHECKING:
    from ...core import KeptStages, Rigged, Settings
    from ...core.numerics.arrays import BoolArray, FloatArray
    from ...core.run.monitor import Cancelled, Progress

RESTS = {"NONE": None, "T": "T", "A": "A", "REFERENCE": "rest"}  # poses at rest, as the core calls them
_NAMES = {"T": "T-Pose", "A": "A-Pose", "REFERENCE": "Rest Pose"}
_LEAST = 5e-4  # weight below which a bone holds no skin, as it may be rounded to 0
_MISSED = 0.01  # of the body's size: error of the key of the scan that is told
_RIG = "Rig of {}"


class RigTask:
    """An armature for objects that are one body.

    The constructor reads all objects, `compute` may run in any thread, and `write` writes.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, accepted by `refusal`, at least one.
    source : RigSource or None
        The rigged character that lends its bones; None for the mannequin.
    settings : Settings
        Options of the forms.
    pose : str
        The pose at rest: one of `RESTS`.
    equal : bool
        Make bones of both sides equally long.
    naming : str
        How the mannequin's bones are called: one of `NAMINGS`.
    rigify : bool
        Generate Rigify's rig on the bones, which must have the mannequin's names.
    side : int
        Which way the body faces: -1 for the likeliest, or its index.
    anyway : bool
        Keep a rig that is unlikely to be right, too.
    keep : KeptStages, optional
        Results of earlier runs on these objects.

    Attributes
    ----------
    warnings : list of str
        Sentences for the user.
    armature : str
        Name of the armature, once it is written.
    bones : int
        How many it has.
    confidence : dict of str to float
        How well each bone that holds skin fits, 0 to 1.
    sides : list of float
        Costs of the ways in which the body may face, the likeliest first.

    Raises
    ------
    CanonicalFormError
        If an object cannot be read, or has a rig of its own.
    """

    def __init__(
        self,
        objects: Sequence[bpy.types.Object],
        source: RigSource | None,
        settings: Settings,
        pose: str,
        *,
        equal: bool = True,
        naming: str = "RIGIFY",
        rigify: bool = False,
        side: int = -1,
        anyway: bool = False,
        keep: KeptStages | None = None,
    ) -> None:
        self._source, self._pose, self._keep = source, pose, keep
        self._equal, self._side, self._anyway = equal, side, anyway
        self._found: Rigged | None = None
        self._naming = naming
        self._names = named_as(MANNEQUIN_BONES, naming) if source is None else source.rig.skeleton.names
        self._rigify = rigify
        if rigify:
            require_rigify(self._names)
        objects = list({obj.data: obj for obj in reversed(objects)}.values())[::-1]
        self._readings = [self._read(obj) for obj in objects]
        for reading in self._readings:
            require_thick(reading.name, reading.placement, alone=len(self._readings) == 1)
        self._vertices, self._faces, self._starts = concatenated(
            [(moved(each.vertices, each.placement), outward(each.faces, each.placement)) for each in self._readings]
        )
        marks = [read_marks(obj, len(each.vertices)) for obj, each in zip(objects, self._readings, strict=True)]
        points = [points_on(*each, points_by_hand(each[0].data)) for each in zip(objects, self._readings, strict=True)]
        starts = self._starts.tolist()
        self._settings = with_points(with_marks(settings, marks, starts), points, starts)
        self._corrected: FloatArray | None = None
        self.warnings = [] if source is None else list(source.warnings)
        self.warnings += [sentence for obj in objects for sentence in _doubts(obj, pose)]
        self.armature, self.bones = "", 0
        self.confidence: dict[str, float] = {}
        self.sides: list[float] = []

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Fit the skeleton and weigh the skin; does not access Blender's data.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `rig`.

        Raises
        ------
        CanonicalFormError
            If a mesh cannot be used, the skeleton is unlikely to be right, or the run was cancelled.
        """
        from ...core import rig
        from ...core.rigging.skeleton import skinned, unskinned

        try:
            found = rig(
                self._vertices,
                self._faces,
                None if self._source is None else self._source.rig,
                self._settings,
                pose=RESTS[self._pose],
                side="auto" if self._side < 0 else self._side,
                equal=self._equal,
                anyway=self._anyway,
                keep=self._keep,
                progress=progress,
                cancelled=cancelled,
            )
        except MemoryError as error:
            name = self._readings[0].name
            raise TooLargeError(
                told("Not enough memory for {name}. Close other files, or decimate the mesh.", name=name)
            ) from error
        self.warnings += all_advised(found.warnings)
        if RESTS[self._pose] is not None:
            self._corrected = unskinned(self._vertices, found.vertices, found.weights, found.to_given)
            reached = skinned(self._corrected, found.weights, found.to_given)
            size = float(np.ptp(self._vertices, axis=0).max())
            off = float(np.linalg.norm(reached - self._vertices, axis=1).max()) / size
            if off > _MISSED:
                self.warnings.append(
                    told("Folds of the skin hide some of the scan: the key Scan misses it by up to {off:.1%}.", off=off)
                )
        if self._source is None:
            names = named_as(found.skeleton.names, self._naming)
            found = replace(found, skeleton=found.skeleton._replace(names=names))
        self._found = found

    def write(self) -> None:
        """Write armature, vertex groups, modifiers and shape keys, in the main thread.

        Raises
        ------
        CanonicalFormError
            If an object was removed or changed, has vertex groups of the bones' names, or the armature cannot be made:
            nothing was written then, and an earlier rig is still there. Only what fails later, as when memory ends
            while objects are bound, leaves them without either.
        """
        found = self._found
        assert found is not None
        objects = [find_object(each) for each in self._readings]
        for obj, reading in zip(objects, self._readings, strict=True):
            with object_mode(obj):
                require_unchanged(obj, reading)
                self._require_room(obj)
        with all_or_nothing() as mark:
            armature, held = self._armature(objects[0], found)  # if that fails, an earlier rig is still there
            left = release(objects)
            if left:
                self.warnings.append(told("Kept, since they may hold your changes: {left}.", left=listed(left)))
            for obj in objects:
                with object_mode(obj):
                    self._require_room(obj)  # what was kept may be in the way
            follow(armature, objects[0])
            token = new_token(objects[0].name)
            self._bind(objects, armature, self._record(armature, found, held, token))
            mark(token)
        armature[MARK] = token
        unnumbered(token)
        self.armature, self.bones = armature.name, len(found.skeleton.names)

    def _armature(self, first: bpy.types.Object, found: Rigged) -> tuple[bpy.types.Object, BoolArray]:
        """Make the armature beside an object; return also which of its bones hold skin, (b,)."""
        skeleton, bends = found.skeleton, found.bends
        if self._source is not None:
            rolls = np.array([self._source.rolls[name] for name in skeleton.names])
            bends = rolled(skeleton.axes, bends, rolls)
        low, high = found.vertices.min(axis=0), found.vertices.max(axis=0)
        origin = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
        held = (found.weights > _LEAST).any(axis=0)
        name = _RIG.format(first.name)
        if self._rigify:
            return add_rigify(name, skeleton, bends, origin, first), held
        return add_armature(name, skeleton, bends, held, origin, first), held

    def _bind(self, objects: list[bpy.types.Object], armature: bpy.types.Object, record: RigRecord) -> None:
        """Bind objects to the armature; all of them or none."""
        found, bound = self._found, []
        assert found is not None
        try:
            for number, obj in enumerate(objects):
                bound.append(obj)
                with object_mode(obj):
                    self._bind_object(obj, number, armature, found, record)
        except BaseException:
            for obj in bound:
                made = read_rig(obj.data)
                if made is not None:
                    with object_mode(obj):
                        unbind(obj, made, armature, unconfirmed=True)
            raise

    def _called(self, name: str) -> str:
        """Return how the bone that moves the skin is called."""
        return DEFORMING + name if self._rigify else name

    def _record(self, armature: bpy.types.Object, found: Rigged, held: BoolArray, token: str) -> RigRecord:
        """Make poses of the armature, colour its doubtful bones, and describe it. `held` (b,): which hold skin."""
        sure = found.confidence.round(3).tolist()
        confidence = {found.skeleton.names[bone]: sure[bone] for bone in np.flatnonzero(held)}
        self.confidence, self.sides = confidence, [float(each) for each in found.match.sides]
        colour_bones(armature, [self._called(name) for name, sure in confidence.items() if sure < DOUBTFUL])
        actions = []
        if self._corrected is not None:
            actions = self._poses(armature, found)
        return RigRecord(
            token,
            armature_fingerprint(armature),
            {action.name: action_fingerprint(action) for action in actions},
            "" if self._source is None else self._source.name,
            self._pose,
            max(self._side, 0),
            self.sides,
            confidence,
            self.warnings,
        )

    def _poses(self, armature: bpy.types.Object, found: Rigged) -> list[bpy.types.Action]:
        """Keep the pose of the scan, and that at rest."""
        bones, back = found.skeleton, found.to_given
        still = back._replace(heads=back.starts, turns=np.broadcast_to(np.eye(3), back.turns.shape))
        poses = {SCAN: back, _NAMES[self._pose]: still}
        if not self._rigify:
            return [add_pose(armature, name, bone_matrices(armature, bones, each)) for name, each in poses.items()]
        origin = np.array(armature.location)
        made = {name: add_rigify_pose(armature, name, bones, each, origin) for name, each in poses.items()}
        self.warnings += [
            told("Rigify's controls do not reach the pose {name}: it was left out.", name=name)
            for name, action in made.items()
            if action is None
        ]
        return [action for action in made.values() if action is not None]

    def _bind_object(
        self, obj: bpy.types.Object, number: int, armature: bpy.types.Object, found: Rigged, about: RigRecord
    ) -> None:
        """Bind one object; what was written is recorded even after an error."""
        record = replace(about, groups={}, keys={})
        start, end = self._starts[number : number + 2]
        active, back = active_items(obj), np.linalg.inv(self._readings[number].placement)
        try:
            for name, weights in zip(found.skeleton.names, in_steps(found.weights[start:end]).T, strict=True):
                if weights.any():
                    group = obj.vertex_groups.new(name=self._called(name))
                    record.groups[group.name] = ""  # not filled yet
                    record.groups[group.name] = fill_group(group, np.where(weights > 0, weights, np.nan))
            if self._corrected is not None:
                shapes = [moved(each[start:end], back) for each in (found.vertices, self._corrected)]
                self._add_keys(obj, shapes, record)
            modifier = obj.modifiers.new("Armature", "ARMATURE")
            modifier.object = armature
            obj.modifiers.move(len(obj.modifiers) - 1, 0)
            if obj.parent is None:
                record.inverse = np.ravel(obj.matrix_parent_inverse).tolist()
                obj.parent = armature
                obj.matrix_parent_inverse = armature.matrix_world.inverted()
        finally:
            write_rig(obj.data, record)
        restore_active_items(obj, active.kept(existing_items(obj), otherwise=active_items(obj)))
        obj.data.update()

    def _add_keys(self, obj: bpy.types.Object, shapes: Sequence[FloatArray], record: RigRecord) -> None:
        """Add the shape at rest, switched on, and what makes the pose of the scan exact, relative to it."""
        if obj.data.shape_keys is None:
            obj.shape_key_add(name="Basis", from_mix=False)
            record.basis = True
        form = form_key(obj.data)
        if form is not None and form.value:  # with both, the mesh would be moved twice
            record.slider, form.value = form.value, 0.0
            if has_in_betweens(obj.data):
                obj.data.shape_keys[PROPERTY] = 0.0
        before = obj.data.shape_keys.reference_key
        for name, shape, value in zip((_NAMES[self._pose], SCAN), shapes, (1.0, 0.0), strict=True):
            key = obj.shape_key_add(name=f"{name} at Rest" if value else name, from_mix=False)
            record.keys[key.name] = ""  # not filled yet
            key.points.foreach_set("co", shape.astype(np.float32).ravel())
            key.relative_key, key.value, before = before, value, key
            record.keys[key.name] = key_fingerprint(key)

    def _read(self, obj: bpy.types.Object) -> Reading:
        """Read an object that has no rig but one of ours."""
        own = armature_given_to(obj)
        others = [each for each in rigs_of(obj) if each != own]
        if others:
            raise CanonicalFormError(
                told(
                    "{name} is moved by the rig {rig} already. Remove its Armature modifier and its parent first.",
                    name=obj.name,
                    rig=others[0].name,
                )
            )
        if self._pose != "NONE" and sum(each.data == obj.data for each in bpy.data.objects) > 1:
            raise CanonicalFormError(
                told(
                    "{name} shares its mesh with other objects, which would move, too. Make it a single user first "
                    "(Object > Relations > Make Single User > Object & Data).",
                    name=obj.name,
                )
            )
        with object_mode(obj):
            self._require_room(obj)
            reading = read_object(obj)
        if reading.mirrors:
            raise CanonicalFormError(told("{name} has a Mirror modifier. Apply it first.", name=obj.name))
        return reading

    def _require_room(self, obj: bpy.types.Object) -> None:
        """Require that no group of the user has the name of a bone."""
        record = read_rig(obj.data)
        known = {} if record is None else record.groups
        names = self._names if self._found is None else self._found.skeleton.names
        there = [name for name in map(self._called, names) if name in obj.vertex_groups]
        prints = group_fingerprints(obj, {name: known.get(name) for name in there})
        own = [name for name in there if known.get(name) is None or prints[name] != known[name]]
        if own:
            raise CanonicalFormError(
                told(
                    "{name} has vertex groups of its own called {left}. Rename or remove them first.",
                    name=obj.name,
                    left=listed(own),
                )
            )


def _doubts(obj: bpy.types.Object, pose: str) -> list[str]:
    """Say what of an object will not follow the armature, or hides it."""
    doubts = []
    data = obj.animation_data
    own = data is not None and (data.action is not None or data.nla_tracks or data.drivers)
    if own or any(not each.mute for each in obj.constraints):
        doubts.append(
            told("{name} is animated, or held by a constraint: its armature does not follow that.", name=obj.name)
        )
    if obj.show_only_shape_key and pose != "NONE":
        doubts.append(
            told("{name} shows only its active shape key, and not that of the rest. Unpin it there.", name=obj.name)
        )
    return doubts
