"""Random walks through the extension: no sequence of steps changes data that belong to the user.

After every step of the extension the user's data are unchanged, and every error is a sentence. Works in the bpy module
and, with `undo`, in a window.
"""

import random
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np

from tests.blender.rig_walks import RigSteps
from tests.blender.user_data import (
    QUICK,
    add_hat,
    colours,
    differing,
    leave_out_results,
    orphans,
    positions,
    valued_keys,
)


class Walk(RigSteps):
    """One walk.

    Parameters
    ----------
    package : str
        Name of the package `addon` that is registered: it differs between the bpy module and an installed extension.
    arrays : (vertices, faces)
        The mesh at the start.
    seed : int or random.Random
        Seed or source of the random choices.
    undo : bool
        Whether undo and redo are among the steps.
    """

    def __init__(self, package, arrays, seed, undo=False):
        self.read_record = import_module(f"{package}.blender.records.record").read_record
        self.fingerprints = import_module(f"{package}.blender.mesh_items.fingerprints")
        self.is_made_up = import_module(f"{package}.blender.results.edited_results").is_made_up
        self.core = import_module(f"{package}.core")
        super().__init__(package)
        self.form_task = import_module(f"{package}.blender.jobs.form_task")
        self.request = import_module(f"{package}.blender.jobs.request")
        self.arrays, self.undo = arrays, undo
        self.chance = seed if isinstance(seed, random.Random) else random.Random(seed)
        self.steps, self.counts, self.number = [], {}, 0
        self.folder = Path(tempfile.mkdtemp())

    def run(self, steps):
        """Take steps; raise an AssertionError at the first that changes user data or fails without a sentence."""
        self._fresh()
        ours = [self.compute, self.compute, self.cancelled, self.clear, self.limb, self.in_betweens, self.distance,
                self.choose, self.select_patch, self.compute_together, self.remove_anyway, self.pose_like,
                self.rig, self.rig, self.remove_rig]  # fmt: skip
        theirs = [self.mode, self.mode, self.move, self.add_key, self.add_group, self.add_colours, self.rename_ours,
                  self.spoil_ours, self.delete_ours, self.delete_vertices, self.slide, self.copy_object, self.new_mesh,
                  self.reload, self.other_data, self.other_hat, self.change_armature]  # fmt: skip
        if self.undo:
            theirs += [self.undo_step, self.undo_step, self.redo_step]
            ours += [self.computed_and_undone, self.computed_and_undone]
        for _ in range(steps):
            mine = self.chance.random() < 0.55
            step = self.chance.choice(ours if mine else theirs)
            self.steps.append(step.__name__)
            self.counts[step.__name__] = self.counts.get(step.__name__, 0) + 1
            before: Any = self.view() if mine else None
            written: Any = self.ours()["keys"] | self.ours(self.hat)["keys"] if mine else None
            valued = valued_keys([self.obj, self.hat] if mine else [], self.read_record)
            rig = self.read_rig(self.obj.data)
            valued |= dict.fromkeys(rig.keys if mine and rig is not None else (), False)
            unused = orphans() if mine else None
            try:
                step()
            except (RuntimeError, self.core.CanonicalFormError) as error:
                message = str(error).strip()
            else:
                message = "Error: ."
            assert message.endswith(".") or ".poll() " in message or message.startswith("Error: "), message
            assert "Traceback" not in message, message
            if self.undo and not mine:
                bpy.ops.ed.undo_push(message=step.__name__)
            if mine:
                after = self.view()
                leave_out_results(before, after, written, valued)
                assert orphans() <= unused, self.steps[-8:]
                for part, value in before.items():
                    assert after[part] == value, (part, differing(value, after[part]), self.steps[-8:])

    def _fresh(self):
        vertices, faces = self.arrays
        mesh = bpy.data.meshes.new("Walker")
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        obj = bpy.data.objects.new("Walker", mesh)
        bpy.context.scene.collection.objects.link(obj)
        self._activate(obj)
        if self.hat is None:
            add_hat(self.arrays[0])

    @property
    def hat(self):
        return bpy.data.objects.get("Hat")

    @property
    def obj(self):
        return bpy.data.objects[self.name]

    def op(self, operator, **options):
        """Run an operator as a button does: with a step to undo where there is a window."""
        return operator("EXEC_DEFAULT", self.undo, **options)

    def ours(self, obj=None):
        """Name the items that are unchanged since the last run wrote them, by kind."""
        obj = obj or self.obj
        mesh = obj.data
        record = self.read_record(mesh)
        keys = mesh.shape_keys.key_blocks if mesh.shape_keys else {}
        bound = self.bound(obj, keys)
        if record is None:
            return bound
        named = {**record.keys, **record.in_between_keys}
        key_fingerprint, colour_fingerprint = self.fingerprints.key_fingerprint, self.fingerprints.colour_fingerprint
        found = {"keys": {name for name, known in named.items()
                          if name in keys and known in (None, key_fingerprint(keys[name]))}}  # fmt: skip
        basis = record.basis
        if basis and basis in keys and record.basis_fingerprint in (None, key_fingerprint(keys[basis])):
            found["keys"].add(basis)
        groups = self.fingerprints.group_fingerprints(obj, record.groups)
        made_up = self.is_made_up(obj, record)  # by Blender, for other vertices
        found["groups"] = {name for name in groups if made_up or record.groups[name] in (None, groups[name])}
        colours_of = mesh.color_attributes
        found["colours"] = {name for name, known in record.colours.items() if name in colours_of
                            and (made_up or known in (None, colour_fingerprint(colours_of[name])))}  # fmt: skip
        return {kind: names | bound[kind] for kind, names in found.items()}

    def view(self):
        """Record the user's data, bit for bit."""
        obj = self.obj
        mode = obj.mode
        self.op(bpy.ops.object.mode_set, mode="OBJECT")  # elsewhere not all can be read
        found = self._view(obj, obj.data, self.ours())
        hat = self._view(self.hat, self.hat.data, self.ours(self.hat)) if self.hat else {}
        self.op(bpy.ops.object.mode_set, mode=mode)
        return {"mode": mode, **found, **{f"hat {part}": value for part, value in hat.items()}}

    def _view(self, obj, mesh, ours):
        measured = ("Heat Geodesic", "Chosen Feature Points", "Attribute")  # the last is what vertex painting adds
        points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
        (mesh.shape_keys.reference_key.data if mesh.shape_keys else mesh.vertices).foreach_get("co", points)
        keys = mesh.shape_keys.key_blocks if mesh.shape_keys else []
        groups = {group.index: group.name.replace(" (kept)", "") for group in obj.vertex_groups  # they make room
                  if group.name not in ours["groups"] and not group.name.startswith(measured)}  # fmt: skip
        return {
            "basis": points.tobytes(),
            "polygons": [tuple(polygon.vertices) for polygon in mesh.polygons],
            "selected": [vertex.select for vertex in mesh.vertices] if self.steps[-1] != "select_patch" else None,
            # the value of a form's key is driven by ours where there are in-betweens
            "keys": {key.name: (positions(key), key.name.startswith("Canonical Form") or round(key.value, 6),
                                key.mute, key.lock_shape)
                     for key in keys if key.name not in ours["keys"]},
            "groups": sorted(groups.values()),
            "weights": [sorted((groups[part.group], part.weight) for part in vertex.groups if part.group in groups)
                        for vertex in mesh.vertices],
            "colours": {each.name: colours(each) for each in mesh.color_attributes
                        if each.name not in ours["colours"] and not each.name.startswith(measured)},
            "materials": [slot and slot.name for slot in mesh.materials],
            "note": mesh.get("note"),
            "objects": sorted(each.name for each in bpy.data.objects
                              if "Canonical Form" not in each.name and not each.name.startswith("Rig of")),
        }  # fmt: skip

    # steps of the extension

    def compute(self):
        kinds: list[dict[str, Any]] = [
            {}, {}, {"step": "PATCHES"}, {"step": "FEATURES"}, {"mesh": "SHOWN"}, {"result": "OBJECT"}, {"value": 0.3},
            {"feature_points": "0,5"},
        ]  # fmt: skip
        self.op(bpy.ops.object.canonical_form, **QUICK, **self.chance.choice(kinds))
        for obj in list(bpy.data.objects):
            if "Canonical Form" in obj.name and obj.name != self.name:  # which undo may have made the walker
                bpy.data.meshes.remove(obj.data)
                bpy.data.orphans_purge()

    def compute_together(self):
        if self.hat is not None:
            self.hat.select_set(True)
        options = [{}, {"objects": "TOGETHER"}, {"objects": "EACH"}, {"step": "PATCHES"}, {"mesh": "SHOWN"}]
        self.op(bpy.ops.object.canonical_form, **QUICK, **self.chance.choice(options))

    def pose_like(self):
        name = "Nobody" if self.hat is None else self.hat.name
        self.op(bpy.ops.object.canonical_form_pose_like, **QUICK, like=name, side=self.chance.choice([-1, 1]))

    def remove_anyway(self):
        self.op(bpy.ops.object.canonical_form_remove_in_betweens)

    def computed_and_undone(self):
        bpy.ops.ed.undo_push(message="Before")
        before = self.read_record(self.obj.data)
        self.op(bpy.ops.object.canonical_form, **QUICK)
        bpy.ops.ed.undo()
        assert self.read_record(self.obj.data) == before, "undo left something"

    def cancelled(self):
        asked, after = [0], self.chance.randrange(120)

        def stop():
            asked[0] += 1
            return asked[0] > after

        task = self.form_task.FormTask([self.obj], self.request.Request())
        try:
            task.compute(None, stop)
        except self.core.CancelledError:
            return
        task.write()

    def clear(self):
        self.op(bpy.ops.object.canonical_form_clear)
        assert self.read_record(self.obj.data) is None

    def limb(self):
        self.op(bpy.ops.object.canonical_form_limb, patch=self.chance.randrange(4), only=self.chance.random() < 0.5)

    def in_betweens(self):
        self.op(bpy.ops.object.canonical_form_in_betweens, count=self.chance.randrange(4))

    def distance(self):
        self.op(bpy.ops.object.canonical_form_distance, kind="heat", isolines=self.chance.choice([0, 5]))

    def choose(self):
        self.op(bpy.ops.object.canonical_form_choose, how=self.chance.choice(["SET", "ADD", "REMOVE"]))

    def select_patch(self):
        self.op(bpy.ops.object.canonical_form_select_patch, patch=1 + self.chance.randrange(3))

    # steps of the user

    def mode(self):
        modes = ["OBJECT", "OBJECT", "EDIT", "WEIGHT_PAINT", "VERTEX_PAINT"]
        self.op(bpy.ops.object.mode_set, mode=self.chance.choice(modes))

    def _object_mode(self):
        self.op(bpy.ops.object.mode_set, mode="OBJECT")
        return self.obj.data

    def move(self):
        mesh = self._object_mode()
        keys = mesh.shape_keys.key_blocks if mesh.shape_keys else None
        where = self.chance.choice(list(keys)).data if keys else mesh.vertices
        for _ in range(3):
            where[self.chance.randrange(len(where))].co.x += 0.05
        mesh.update()

    def add_key(self):
        self._object_mode()
        if self.obj.data.shape_keys is None or len(self.obj.data.shape_keys.key_blocks) < 12:
            self.obj.shape_key_add(name=self.chance.choice(["Smile", "Canonical Form", "Basis", "Key"]), from_mix=False)

    def add_group(self):
        self._object_mode()
        if len(self.obj.vertex_groups) < 20:
            group = self.obj.vertex_groups.new(name=self.chance.choice(["Mine", "Feature Points", "Patch 1"]))
            group.add([self.chance.randrange(len(self.obj.data.vertices)) for _ in range(4)], 0.5, "REPLACE")

    def add_colours(self):
        mesh = self._object_mode()
        if len(mesh.color_attributes) < 6:
            mesh.color_attributes.new(name=self.chance.choice(["Mine", "Patches"]), type="FLOAT_COLOR", domain="POINT")

    def _one_of_ours(self):
        ours = self.ours()
        kind = self.chance.choice(list(ours))
        return kind, self.chance.choice(sorted(ours[kind])) if ours[kind] else None

    def rename_ours(self):
        mesh = self._object_mode()
        kind, name = self._one_of_ours()
        if name is not None:
            self.number += 1
            places = {"keys": mesh.shape_keys and mesh.shape_keys.key_blocks, "groups": self.obj.vertex_groups,
                      "colours": mesh.color_attributes}  # fmt: skip
            places[kind][name].name = f"Taken {self.number}"

    def spoil_ours(self):
        mesh = self._object_mode()
        kind, name = self._one_of_ours()
        if name is None:
            return
        if kind == "keys":
            mesh.shape_keys.key_blocks[name].data[0].co.y += 0.1
        elif kind == "groups":
            self.obj.vertex_groups[name].add([0, 1], 0.25, "REPLACE")
        else:
            mesh.color_attributes[name].data[0].color = (1, 0, 0, 1)

    def delete_ours(self):
        mesh = self._object_mode()
        kind, name = self._one_of_ours()
        if name is None:
            return
        if kind == "keys":
            self.obj.active_shape_key_index = mesh.shape_keys.key_blocks.find(name)
            self.op(bpy.ops.object.shape_key_remove)  # as the button does: of driven keys the function alone is unsafe
        elif kind == "groups":
            self.obj.vertex_groups.remove(self.obj.vertex_groups[name])
        else:
            mesh.color_attributes.remove(mesh.color_attributes[name])

    def delete_vertices(self):
        mesh = self._object_mode()
        if len(mesh.vertices) < 200:
            return self.new_mesh()
        edited = bmesh.new()
        edited.from_mesh(mesh)
        edited.verts.ensure_lookup_table()
        some = [edited.verts[self.chance.randrange(len(edited.verts))]]
        bmesh.ops.delete(edited, geom=some, context="VERTS")
        edited.to_mesh(mesh)
        edited.free()
        return mesh.update()

    def slide(self):
        if self.obj.data.shape_keys is not None:
            for key in list(self.obj.data.shape_keys.key_blocks)[1:]:
                key.value = self.chance.random()

    def copy_object(self):
        self._object_mode()
        old = self.obj
        new = old.copy()
        if self.chance.random() < 0.5:
            new.data = old.data.copy()
        bpy.context.scene.collection.objects.link(new)
        gone = old.data
        bpy.data.objects.remove(old)
        if gone.users == 0:
            bpy.data.meshes.remove(gone)
        self._activate(new)

    def new_mesh(self):
        self._object_mode()
        mesh = self.obj.data
        bpy.data.meshes.remove(mesh)
        bpy.data.orphans_purge()
        self._fresh()

    def _activate(self, obj):
        bpy.context.view_layer.update()
        for other in bpy.context.view_layer.objects:
            other.select_set(other == obj)
        bpy.context.view_layer.objects.active = obj
        self.name = obj.name

    def reload(self):
        self._object_mode()
        path = str(self.folder / "walk.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path, copy=self.undo, check_existing=False)
        if not self.undo:  # in a window it would take this session's timers along
            bpy.ops.wm.open_mainfile(filepath=path, load_ui=False)
            self._activate(self.obj)

    def other_data(self):
        self.obj.data["note"] = self.chance.random()

    def other_hat(self):
        self._object_mode()
        hat = self.hat
        if hat is None:
            add_hat(self.arrays[0])
        elif self.chance.random() < 0.4:
            bpy.data.meshes.remove(hat.data)
        else:
            hat.location.x += 0.01
        bpy.context.view_layer.update()

    def undo_step(self):
        bpy.ops.ed.undo()
        self._found_again()

    def redo_step(self):
        bpy.ops.ed.redo()
        self._found_again()

    def _found_again(self):
        """After an undo the walker may be another object, or none."""
        meshes = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH"]
        if not meshes:
            self._fresh()
        elif self.name not in bpy.context.view_layer.objects or bpy.context.view_layer.objects.active != self.obj:
            self._activate(meshes[0])
