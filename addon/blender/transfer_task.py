"""Takes over from another object what it has: read, matched apart from Blender, written."""

from __future__ import annotations

from collections.abc import Iterator, Set
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ..core import CanonicalFormError, TooLargeError
from ..core.numerics.arrays import FloatArray, IntArray
from .active_items import active_items, existing_items, restore_active_items
from .advice import all_advised
from .combining import moved
from .fingerprints import colour_fingerprint, key_fingerprint, uv_fingerprint
from .form_key import form_key
from .group_weights import fill_group
from .in_betweens import PROPERTY, has_in_betweens
from .mesh_reading import find_object, read_mesh, read_object, require_unchanged
from .object_states import object_mode
from .placement import placement_of
from .pose_reading import reference_refusal
from .record import read_record
from .transfer_reading import Source, read_source
from .transfer_record import Written, make_room, read_transfers, write_transfers
from .wording import told

if TYPE_CHECKING:
    from ..core import Match, Settings
    from ..core.run.monitor import Cancelled, Progress

TRANSFERS = ("GROUPS", "UVS", "COLOURS", "KEYS", "MATERIALS")
REST = "Rest of {}"
_LEAST = 5e-4  # weight below which a vertex is no member: it would be rounded to 0
_LIKE_SIZED = 1.25  # times as large as the rig's own body, or as small, from which on it hardly fits
_CALLED = {"groups": "vertex groups", "uvs": "UV maps", "colours": "colour attributes", "keys": "shape keys"}


class _Carried(NamedTuple):
    """What was carried over, by name."""

    groups: dict[str, FloatArray]
    uvs: dict[str, FloatArray]
    colours: dict[str, tuple[str, str, FloatArray]]
    keys: dict[str, tuple[FloatArray, tuple[float, float]]]
    material_of: IntArray | None
    rest: FloatArray | None


class TransferTask:
    """What an object takes over from another.

    The constructor reads both, `compute` may run in any thread, and `write` writes.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`.
    source : bpy.types.Object or None
        The other one.
    kinds : set of str
        What is taken over, of `TRANSFERS`.
    settings : Settings
        Options of the forms of both.
    side : int
        Which way to match: -1 for the likeliest, or its number.

    Attributes
    ----------
    warnings : list of str
        Sentences for the user.
    told : list of str
        What was taken over, in words.

    Raises
    ------
    CanonicalFormError
        If there is nothing to take over, or one of the two cannot be read.
    """

    def __init__(
        self, obj: bpy.types.Object, source: bpy.types.Object | None, kinds: Set[str], settings: Settings, side: int
    ) -> None:
        reason = reference_refusal(source)
        if source is None or reason is not None:
            raise CanonicalFormError(reason or "")
        if source == obj:
            raise CanonicalFormError(
                told("{name} is the reference itself. Select the mesh that is to take over.", name=obj.name)
            )
        if not kinds:
            raise CanonicalFormError(told("Nothing is chosen to be transferred."))
        with object_mode(obj):
            self._reading = read_object(obj)
            if self._reading.mirrors:
                raise CanonicalFormError(told("{name} has a Mirror modifier. Apply it first.", name=obj.name))
            mesh = obj.data
            vertex_of = np.empty(len(mesh.loops), dtype=np.int32)
            mesh.loops.foreach_get("vertex_index", vertex_of)
            self._vertex_of: IntArray = vertex_of.astype(np.int64)
            sizes = np.empty(len(mesh.polygons), dtype=np.int32)
            mesh.polygons.foreach_get("loop_total", sizes)
            self._polygon_of = np.repeat(np.arange(len(sizes)), sizes)
        with object_mode(source):
            self._there, self._there_faces = read_mesh(source.data)
            self._source: Source = read_source(source)
            self._there_placement = placement_of(source, False)
        self._kinds, self._settings, self._side = kinds, settings, side
        self._rigged = "GROUPS" in kinds and bool(self._source.armature)
        self._carried: _Carried | None = None
        self.warnings: list[str] = []
        self.told: list[str] = []

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Match the two and carry over; touches no data of Blender's.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `match`.

        Raises
        ------
        CanonicalFormError
            If a mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        from ..core import match, pose_like

        reading = self._reading
        placed, faces = _placed(reading.vertices, reading.faces, reading.placement)
        there, there_faces = _placed(self._there, self._there_faces, self._there_placement)
        side = "auto" if self._side < 0 else self._side
        rest = None
        try:
            if self._rigged:
                posed = pose_like(
                    placed, faces, there, there_faces, self._settings, side=side, progress=progress, cancelled=cancelled
                )
                found = posed.match
                rest = self._in_the_rig(posed.vertices, found, there)
                self._warn_of_size(placed, faces, there, there_faces)
            else:
                found = match(
                    placed, faces, there, there_faces, self._settings, side=side, progress=progress, cancelled=cancelled
                )
        except MemoryError as error:
            raise TooLargeError(
                told("Not enough memory for {name}. Close other files, or decimate the mesh.", name=self._reading.name)
            ) from error
        self.warnings += all_advised([*found.warnings, *found.other_warnings])
        self._carried = self._carry(found, rest)

    def write(self) -> None:
        """Write what was carried over, on the main thread.

        Raises
        ------
        CanonicalFormError
            If the object is gone or was changed; the message says why.
        """
        assert self._carried is not None
        obj = find_object(self._reading)
        with object_mode(obj):
            require_unchanged(obj, self._reading)
            written, active = read_transfers(obj.data), active_items(obj)
            with _recording(obj.data, written):
                self._write_groups(obj, self._carried, written)
                self._write_uvs(obj, self._carried, written)
                self._write_colours(obj, self._carried, written)
                self._write_keys(obj, self._carried, written)
                if self._carried.material_of is not None:
                    self._write_materials(obj, self._carried.material_of)
            restore_active_items(obj, active.kept(existing_items(obj), otherwise=active_items(obj)))
            obj.data.update()

    def _in_the_rig(self, posed: FloatArray, found: Match, there: FloatArray) -> FloatArray:
        """Move what was posed as the rig rests to where the rig is, in the object's own space."""
        from ..core import transferred
        from ..core.measures.alignment import rigid_fit

        known = found.confidence > np.median(found.confidence) / 2
        rotation, shift = rigid_fit(posed[known], transferred(found, there)[known])
        return moved(posed @ rotation + shift, np.linalg.inv(self._reading.placement))

    def _warn_of_size(self, placed: FloatArray, faces: IntArray, there: FloatArray, there_faces: IntArray) -> None:
        """Tell where a body is too large or small for the rig."""
        from ..core.mesh.geometry import surface_area

        times = float(np.sqrt(surface_area(placed, faces) / surface_area(there, there_faces)))
        if not 1 / _LIKE_SIZED < times < _LIKE_SIZED:
            self.warnings.append(
                told(
                    "{name} is {times:.2g} times as large as {source}. Scale it first, for the rig to fit.",
                    name=self._reading.name,
                    times=times,
                    source=self._source.name,
                )
            )

    def _carry(self, found: Match, rest: FloatArray | None) -> _Carried:
        """Carry over what is wanted."""
        from ..core import transferred, transferred_corners

        source, kinds = self._source, self._kinds

        def on_corners(values: FloatArray) -> FloatArray:
            return transferred_corners(
                found, self._polygon_of, self._vertex_of, self._there, source.triangle_corners, values, source.vertex_of
            )

        groups: dict[str, FloatArray] = {}
        if "GROUPS" in kinds and source.groups:
            weights = transferred(found, np.column_stack(list(source.groups.values())))
            groups = dict(zip(source.groups, weights.T, strict=True))
        uvs = {name: on_corners(values) for name, values in source.uvs.items()} if "UVS" in kinds else {}
        colours = {
            each.name: (
                "CORNER" if each.on_corners else "POINT",
                each.data_type,
                on_corners(each.values) if each.on_corners else transferred(found, each.values),
            )
            for each in (source.colours if "COLOURS" in kinds else ())
        }
        keys = {
            each.name: (self._changed_like(each.shape, found, rest), each.limits)
            for each in (source.keys if "KEYS" in kinds else ())
        }
        material_of = self._material_of(found) if "MATERIALS" in kinds else None
        return _Carried(groups, uvs, colours, keys, material_of, rest)

    def _changed_like(self, shape: FloatArray, found: Match, rest: FloatArray | None) -> FloatArray:
        """Change the shape, as it rests or as it is, like a key of the source; as the scene shows both."""
        from ..core import transferred_shape

        reading, there = self._reading, self._there_placement
        start = reading.vertices if rest is None else rest
        placed, faces = _placed(start, reading.faces, reading.placement)
        after = transferred_shape(found, placed, faces, moved(self._there, there), moved(shape, there))
        return moved(after, np.linalg.inv(reading.placement)) - start + reading.vertices

    def _material_of(self, found: Match) -> IntArray:
        """Find the slot of the source that each polygon takes its material from: that of most of its corners."""
        triangles = self._source.vertex_of[self._source.triangle_corners]
        slots = np.zeros(len(self._there), dtype=np.int64)
        slots[triangles.ravel()] = np.repeat(self._source.material_of, 3)
        count = np.zeros((int(self._polygon_of.max()) + 1, int(slots.max()) + 1), dtype=np.int64)
        np.add.at(count, (self._polygon_of, slots[found.vertices[self._vertex_of]]), 1)
        return np.asarray(count.argmax(axis=1))

    def _room(self, obj: bpy.types.Object, kind: str, names: list[str], written: Written) -> list[str]:
        """List which items can be written, and warn of those that the user has under the same name."""
        left = make_room(obj, kind, names, written)
        if left:
            self.warnings.append(
                told(
                    "{name} has {kind} of its own called {left}. They were kept; rename them to "
                    "take over those of {source}.",
                    name=obj.name,
                    kind=told(_CALLED[kind]),
                    left=", ".join(left),
                    source=self._source.name,
                )
            )
        kept = [name for name in names if name not in left]
        if kept:
            self.told.append(f"{told(_CALLED[kind])}: {len(kept)}")
        return kept

    def _write_groups(self, obj: bpy.types.Object, carried: _Carried, written: Written) -> None:
        """Write weights, and set up the armature that uses them."""
        for name in self._room(obj, "groups", list(carried.groups), written):
            weights = carried.groups[name]
            group = obj.vertex_groups.new(name=name)
            written["groups"][group.name] = fill_group(group, np.where(weights > _LEAST, weights, np.nan))
        armature = bpy.data.objects.get(self._source.armature) if carried.rest is not None else None
        if armature is None:
            return
        if not any(each.type == "ARMATURE" and each.object == armature for each in obj.modifiers):
            modifier = obj.modifiers.new("Armature", "ARMATURE")
            modifier.object = armature
            obj.modifiers.move(len(obj.modifiers) - 1, 0)
        self.told.append(told("the rig {name}", name=armature.name))

    def _write_uvs(self, obj: bpy.types.Object, carried: _Carried, written: Written) -> None:
        """Write UV maps."""
        for name in self._room(obj, "uvs", list(carried.uvs), written):
            layer = obj.data.uv_layers.new(name=name, do_init=False)
            if layer is None:
                self.warnings.append(
                    told("{name} has no room for another UV map: {map} was left out.", name=obj.name, map=name)
                )
                continue
            layer.uv.foreach_set("vector", carried.uvs[name].astype(np.float32).ravel())
            written["uvs"][layer.name] = uv_fingerprint(layer)

    def _write_colours(self, obj: bpy.types.Object, carried: _Carried, written: Written) -> None:
        """Write colour attributes."""
        for name in self._room(obj, "colours", list(carried.colours), written):
            domain, data_type, values = carried.colours[name]
            attribute = obj.data.color_attributes.new(name=name, type=data_type, domain=domain)
            attribute.data.foreach_set("color", values.astype(np.float32).ravel())
            written["colours"][attribute.name] = colour_fingerprint(attribute)

    def _write_keys(self, obj: bpy.types.Object, carried: _Carried, written: Written) -> None:
        """Write shape keys, all at 0 but that of the rig's rest pose."""
        shapes = dict(carried.keys)
        if carried.rest is not None:
            shapes = {REST.format(self._source.name): (carried.rest, (0.0, 1.0)), **shapes}
        names = self._room(obj, "keys", list(shapes), written)
        if names and obj.data.shape_keys is None:
            obj.shape_key_add(name="Basis", from_mix=False)
        for name in names:
            shape, (low, high) = shapes[name]
            key = obj.shape_key_add(name=name, from_mix=False)
            key.relative_key = obj.data.shape_keys.reference_key
            key.data.foreach_set("co", shape.astype(np.float32).ravel())
            key.slider_min, key.slider_max = low, high
            key.value = float(shape is carried.rest)
            written["keys"][key.name] = key_fingerprint(key)
        form = form_key(obj.data)
        if carried.rest is not None and form is not None:  # both at once would move it twice
            form.value = 0.0
            if has_in_betweens(obj.data):
                obj.data.shape_keys[PROPERTY] = 0.0

    def _write_materials(self, obj: bpy.types.Object, material_of: IntArray) -> None:
        """Give the polygons the materials of their likes; the object's own stay in their slots."""
        used = np.unique(material_of)
        slot = np.zeros(int(used.max()) + 1, dtype=np.int32)
        for number in used.tolist():
            name = self._source.materials[number] if number < len(self._source.materials) else ""
            material = bpy.data.materials.get(name)
            if material is None:
                continue
            mine = [each.material for each in obj.material_slots]
            if material not in mine:
                obj.data.materials.append(material)
                mine.append(material)
            slot[number] = mine.index(material)
        obj.data.polygons.foreach_set("material_index", slot[material_of])
        self.told.append(told("materials"))


def _placed(points: FloatArray, faces: IntArray, placement: FloatArray) -> tuple[FloatArray, IntArray]:
    """Place a mesh in the scene, its triangles seen from outside as before."""
    return moved(points, placement), faces if np.linalg.det(placement[:3, :3]) > 0 else faces[:, ::-1]


@contextmanager
def _recording(mesh: bpy.types.Mesh, written: Written) -> Iterator[None]:
    """Write the record in every outcome."""
    try:
        yield
    finally:
        write_transfers(mesh, written)


def side_of(obj: bpy.types.Object, source: str) -> int:
    """Find which way an object was matched with another when it was posed like that.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    source : str
        Name of the other one.

    Returns
    -------
    int
        Number of the way; -1 where it was not posed like that.
    """
    record = read_record(obj.data)
    like = None if record is None else record.report.like
    return like.side if like is not None and (like.pose, like.name) == ("OBJECT", source) else -1
