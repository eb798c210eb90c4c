"""An object that receives data from another: read, assigned its part of the transferred data, written."""

from __future__ import annotations

from collections.abc import Iterator, Set
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError
from ...core.numerics.arrays import FloatArray, IntArray
from ..mesh_items.active_items import active_items, existing_items, restore_active_items
from ..mesh_items.fingerprints import colour_fingerprint, key_fingerprint, uv_fingerprint
from ..mesh_items.group_weights import fill_group
from ..mesh_items.key_points import key_points
from ..objects.body_points import points_by_hand
from ..objects.marked_contacts import read_marks
from ..objects.mesh_reading import find_object, read_object, require_unchanged
from ..objects.object_states import object_mode
from ..records.form_key import form_key
from ..records.transfer_record import REST, Written, make_room, read_transfers, write_transfers
from ..results.in_betweens import PROPERTY, has_in_betweens
from ..words.wording import listed, told
from .transfer_reading import SourceKey

if TYPE_CHECKING:
    from ...core import Match
    from .transfer_reading import Source

_LEAST = 5e-4  # a vertex with a smaller weight is not a member, as it would be rounded to 0
CALLED = {"groups": "vertex groups", "uvs": "UV maps", "colours": "colour attributes", "keys": "shape keys"}


class Carried(NamedTuple):
    """Data transferred to one object, by name.

    Attributes
    ----------
    groups : dict of str to (n,) ndarray of float
        Weights.
    uvs : dict of str to (l, 2) ndarray of float
        UV maps, by corner.
    colours : dict of str to (str, str, ndarray)
        Domain, data type and values of colour attributes.
    keys : dict of str to SourceKey
        Shape keys, with the shapes of this object.
    material_of : (p,) ndarray of int or None
        Material slot of the source for each polygon, -1 where there is none; None if materials are not transferred.
    rest : (n, 3) ndarray of float or None
        Positions in the rest pose of the rig; None without a rig.
    """

    groups: dict[str, FloatArray]
    uvs: dict[str, FloatArray]
    colours: dict[str, tuple[str, str, FloatArray]]
    keys: dict[str, SourceKey]
    material_of: IntArray | None
    rest: FloatArray | None


class TransferItem:
    """An object that receives data from another.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`.

    Attributes
    ----------
    reading : Reading
        Its arrays.
    marks : Marks
        Where it is to be parted.
    points : BodyPoints
        Feature points fixed by hand.
    carried : Carried or None
        The transferred data, once it is computed.
    warnings : list of str
        Sentences for the user.
    told : list of str
        Descriptions of the transferred data.

    Raises
    ------
    CanonicalFormError
        If it has a Mirror modifier, or cannot leave its mode.
    """

    def __init__(self, obj: bpy.types.Object) -> None:
        with object_mode(obj):
            self.reading = read_object(obj)
            if self.reading.mirrors:
                raise CanonicalFormError(told("{name} has a Mirror modifier. Apply it first.", name=obj.name))
            self.marks, self.points = read_marks(obj, len(self.reading.vertices)), points_by_hand(obj.data)
            mesh = obj.data
            vertex_of = np.empty(len(mesh.loops), dtype=np.int32)
            mesh.loops.foreach_get("vertex_index", vertex_of)
            self._vertex_of: IntArray = vertex_of.astype(np.int64)
            sizes = np.empty(len(mesh.polygons), dtype=np.int32)
            mesh.polygons.foreach_get("loop_total", sizes)
            self._polygon_of = np.repeat(np.arange(len(sizes)), sizes)
        self.carried: Carried | None = None
        self.warnings: list[str] = []
        self.told: list[str] = []

    def carry(
        self,
        found: Match,
        source: Source,
        there: FloatArray,
        kinds: Set[str],
        bones: dict[str, FloatArray],
        keys: dict[str, FloatArray],
        rest: FloatArray | None,
    ) -> None:
        """Compute the transferred data; does not access Blender's data.

        Parameters
        ----------
        found : Match
            The match of its vertices.
        source : Source
            Data of the other object.
        there : (n', 3) ndarray of float
            Positions of the other mesh.
        kinds : set of str
            Kinds of data to transfer.
        bones : dict of str to (n,) ndarray of float
            How far each vertex follows each bone of the source, by name, where its skeleton was fitted.
        keys : dict of str to (n, 3) ndarray of float
            Shapes of keys, already transferred, as their size is that of the whole body.
        rest : (n, 3) ndarray of float or None
            Positions in the rest pose of the rig.
        """
        from ...core import transferred, transferred_corners, transferred_labels

        def on_corners(values: FloatArray) -> FloatArray:
            return transferred_corners(
                found, self._polygon_of, self._vertex_of, there, source.triangle_corners, values, source.vertex_of
            )

        groups: dict[str, FloatArray] = {}
        masks = {each.mask for each in source.keys} if "KEYS" in kinds else set()
        wanted = [name for name in source.groups if "GROUPS" in kinds or name in masks]
        if wanted:
            weights = transferred(found, np.column_stack([source.groups[name] for name in wanted]))
            groups = dict(zip(wanted, weights.T, strict=True))
            known = [name for name in wanted if name in bones and bones[name].any()]
            total = sum((groups[name] for name in known), np.zeros(len(weights)))  # which need not be 1
            groups |= {name: bones[name] * total for name in known}
        colours = {
            each.name: (
                "CORNER" if each.on_corners else "POINT",
                each.data_type,
                on_corners(each.values) if each.on_corners else transferred(found, each.values),
            )
            for each in (source.colours if "COLOURS" in kinds else ())
        }
        self.carried = Carried(
            groups,
            {name: on_corners(values) for name, values in source.uvs.items()} if "UVS" in kinds else {},
            colours,
            {each.name: each._replace(shape=keys[each.name]) for each in source.keys if each.name in keys},
            transferred_labels(
                found,
                self._polygon_of,
                self._vertex_of,
                source.vertex_of[source.triangle_corners],
                source.material_of,
            )
            if "MATERIALS" in kinds
            else None,
            rest,
        )

    def require_unchanged(self) -> None:
        """Reject an object that was removed or changed in the meantime.

        Raises
        ------
        CanonicalFormError
            If so; the message names the remedy.
        """
        obj = find_object(self.reading)
        with object_mode(obj):
            require_unchanged(obj, self.reading)

    def write(self, source: Source, armature: bpy.types.Object | None) -> None:
        """Write the transferred data, in the main thread, after `require_unchanged`.

        Parameters
        ----------
        source : Source
            Data of the other object.
        armature : bpy.types.Object or None
            What moves the other object, and is to move this one.
        """
        assert self.carried is not None
        obj = find_object(self.reading)
        with object_mode(obj):
            written, active = read_transfers(obj.data), active_items(obj)
            with _recording(obj.data, written):
                self._write_groups(obj, source, self.carried, armature, written)
                self._write_uvs(obj, source, self.carried, written)
                self._write_colours(obj, source, self.carried, written)
                self._write_keys(obj, source, self.carried, written)
                if self.carried.material_of is not None:
                    self._write_materials(obj, source, self.carried.material_of)
            restore_active_items(obj, active.kept(existing_items(obj), otherwise=active_items(obj)))
            obj.data.update()

    def _room(self, obj: bpy.types.Object, source: Source, kind: str, names: list[str], written: Written) -> list[str]:
        """Return the names that can be written, and warn about the user's items of the same names."""
        left = make_room(obj, kind, names, written, refill=kind in ("uvs", "keys"))
        if left:
            self.warnings.append(
                told(
                    "{name} has {kind} of its own called {left}. They were kept; rename them to "
                    "take over those of {source}.",
                    name=obj.name,
                    kind=told(CALLED[kind]),
                    left=listed(left),
                    source=source.name,
                )
            )
        kept = [name for name in names if name not in left]
        if kept:
            self.told.append(f"{told(CALLED[kind])}: {len(kept)}")
        return kept

    def _write_groups(
        self,
        obj: bpy.types.Object,
        source: Source,
        carried: Carried,
        armature: bpy.types.Object | None,
        written: Written,
    ) -> None:
        """Write weights, and set up the armature for them."""
        room = self._room(obj, source, "groups", list(carried.groups), written)
        for name in room:
            weights = carried.groups[name]
            group = obj.vertex_groups.new(name=name)
            written["groups"][group.name] = fill_group(group, np.where(weights > _LEAST, weights, np.nan))
        if (
            carried.rest is None
            or armature is None
            or (not room and any(each.type == "ARMATURE" for each in obj.modifiers))
        ):
            return  # its own groups belong to a rig of its own
        for name, rig in list(written["rigs"].items()):  # two rigs would move the object twice
            now = getattr(obj.modifiers.get(name), "object", None)
            if now is not None and rig not in bpy.data.objects:  # renamed since
                written["rigs"][name] = now.name
            if now != armature:
                make_room(obj, "rigs", [name], written)
        if not any(each.type == "ARMATURE" and each.object == armature for each in obj.modifiers):
            modifier = obj.modifiers.new("Armature", "ARMATURE")
            modifier.object = armature
            written["rigs"][modifier.name] = armature.name
            obj.modifiers.move(len(obj.modifiers) - 1, 0)
        self.told.append(told("the rig {name}", name=armature.name))

    def _write_uvs(self, obj: bpy.types.Object, source: Source, carried: Carried, written: Written) -> None:
        """Write UV maps."""
        for name in self._room(obj, source, "uvs", list(carried.uvs), written):
            layer = obj.data.uv_layers.get(name) or obj.data.uv_layers.new(name=name, do_init=False)
            if layer is None:
                self.warnings.append(
                    told("{name} has no room for another UV map: {map} was left out.", name=obj.name, map=name)
                )
                continue
            layer.uv.foreach_set("vector", carried.uvs[name].astype(np.float32).ravel())
            written["uvs"][layer.name] = uv_fingerprint(layer)

    def _write_colours(self, obj: bpy.types.Object, source: Source, carried: Carried, written: Written) -> None:
        """Write colour attributes."""
        for name in self._room(obj, source, "colours", list(carried.colours), written):
            domain, data_type, values = carried.colours[name]
            attribute = obj.data.color_attributes.new(name=name, type=data_type, domain=domain)
            attribute.data.foreach_set("color", values.astype(np.float32).ravel())
            written["colours"][attribute.name] = colour_fingerprint(attribute)

    def _write_keys(self, obj: bpy.types.Object, source: Source, carried: Carried, written: Written) -> None:
        """Write shape keys, new ones with value 0, except that of the rig's rest pose, which replaces earlier ones."""
        shapes = dict(carried.keys)
        new = set()
        if carried.rest is not None:
            rest = REST.format(source.name).encode()[:63].decode(errors="ignore")  # Blender's limit, in bytes
            shapes = {rest: SourceKey(rest, carried.rest), **shapes}
            kept = {*shapes, *(key.name for key in source.keys)}  # the source may have taken over a rig itself
            others = [name for name in written["keys"] if name.startswith(REST.format("")) and name not in kept]
            for name in make_room(obj, "keys", others, written):  # changed by the user
                obj.data.shape_keys.key_blocks[name].value = 0.0
        names = self._room(obj, source, "keys", list(shapes), written)
        if names and obj.data.shape_keys is None:
            obj.shape_key_add(name="Basis", from_mix=False)
        for name in names:
            shape = shapes[name].shape
            key = obj.data.shape_keys.key_blocks.get(name)
            if key is None:
                key = obj.shape_key_add(name=name, from_mix=False)
                key.relative_key = obj.data.shape_keys.reference_key
                key.slider_min, key.slider_max = shapes[name].limits
                key.value = 0.0
                if shapes[name].mask in obj.vertex_groups:
                    key.vertex_group = shapes[name].mask
                new.add(name)
            key.points.foreach_set("co", shape.astype(np.float32).ravel())
            if shape is carried.rest:
                key.value = 1.0
            written["keys"][name] = key_fingerprint(key)
        relative = {name: shapes[name].relative for name in names}
        for key in _made_relative(obj.data.shape_keys, relative, new) if names else ():
            written["keys"][key.name] = key_fingerprint(key)
        form = form_key(obj.data)
        if carried.rest is not None and form is not None:  # with both, the object would be moved twice
            form.value = 0.0
            if has_in_betweens(obj.data):
                obj.data.shape_keys[PROPERTY] = 0.0

    def _write_materials(self, obj: bpy.types.Object, source: Source, material_of: IntArray) -> None:
        """Assign the materials of the matching source polygons; its own materials stay in their slots.

        Polygons that match one without a material keep theirs.
        """
        used = np.unique(material_of[material_of >= 0])
        if not obj.material_slots and len(used) and (material_of < 0).any():
            obj.data.materials.append(None)  # polygons without one keep none
        slot = np.full(int(used.max(initial=0)) + 1, -1, dtype=np.int32)
        for number in used.tolist():
            name = source.materials[number] if number < len(source.materials) else ""
            material = bpy.data.materials.get(name)
            if material is None:
                continue
            mine = [each.material for each in obj.material_slots]
            if material not in mine:
                obj.data.materials.append(material)
                mine.append(material)
            slot[number] = mine.index(material)
        own = np.empty(len(material_of), dtype=np.int32)
        obj.data.polygons.foreach_get("material_index", own)
        chosen = np.where(material_of < 0, -1, slot[material_of])
        if (chosen >= 0).any():
            obj.data.polygons.foreach_set("material_index", np.where(chosen >= 0, chosen, own))
            self.told.append(told("materials"))


def _made_relative(keys: bpy.types.Key, relative: dict[str, str], new: Set[str]) -> list[bpy.types.ShapeKey]:
    """Let keys, whose shapes change the Basis, change the keys that they are relative to; new ones as in the source.

    Return those that are relative to others.
    """
    basis = key_points(keys.reference_key)
    done: set[str] = set()
    found = []

    def follow(name: str) -> None:
        key = keys.key_blocks[name]
        done.add(name)
        if name in new and relative[name] in keys.key_blocks:
            key.relative_key = keys.key_blocks[relative[name]]
        other = key.relative_key
        if other in (keys.reference_key, key):
            return
        if other.name in relative and other.name not in done:
            follow(other.name)
        key.points.foreach_set("co", (key_points(key) + key_points(other) - basis).ravel())
        found.append(key)

    for name in relative:
        if name not in done:
            follow(name)
    return found


@contextmanager
def _recording(mesh: bpy.types.Mesh, written: Written) -> Iterator[None]:
    """Write the record, even after an error."""
    try:
        yield
    finally:
        write_transfers(mesh, written)
