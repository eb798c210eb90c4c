"""Steps of random walks that give the walker a rig, change it, and take it away."""

from importlib import import_module
from typing import Any

import bpy
import numpy as np

from tests.blender.user_data import QUICK


class RigSteps:
    """Mixin for walks.

    Parameters
    ----------
    package : str
        Name of the package `addon` that is registered.
    """

    core: Any
    fingerprints: Any
    chance: Any
    obj: Any
    hat: Any
    op: Any
    _object_mode: Any

    def __init__(self, package):
        self.read_rig = import_module(f"{package}.blender.records.rig_record").read_rig
        self.skeletons = import_module(f"{package}.core.rigging.skeleton")
        self.rigged = import_module(f"{package}.core.results").Rigged

    def bound(self, obj, keys):
        """Name the items of a rig that are as they were written, by kind."""
        found: dict[str, set[str]] = {"keys": set(), "groups": set(), "colours": set()}
        rig = self.read_rig(obj.data)
        if rig is not None:
            prints = self.fingerprints.group_fingerprints(obj, rig.groups)
            found["groups"] = {name for name, now in prints.items() if now == rig.groups[name]}
            found["keys"] = {name for name, known in rig.keys.items()
                             if name in keys and self.fingerprints.key_fingerprint(keys[name]) == known}  # fmt: skip
            if rig.basis:
                found["keys"].add("Basis")
        return found

    def rig(self):
        """Give the walker two bones, without the fit, which takes long."""
        found = self.core.rig
        setattr(self.core, "rig", self._two_bones)  # noqa: B010 (a module, for the type checker)
        try:
            self.op(bpy.ops.object.canonical_form_rig, **QUICK, rest=self.chance.choice(["NONE", "T"]))
        finally:
            setattr(self.core, "rig", found)  # noqa: B010

    def _two_bones(self, vertices, faces, *_, pose, **__):
        low, high = vertices[:, 2].min(), vertices[:, 2].max()
        ends = np.array([[0, 0, low], [0, 0, (low + high) / 2], [0, 0, high]])
        bones = self.skeletons.Skeleton(["Low", "High"], np.array([-1, 0]), ends[:2], ends[1:])
        share = (vertices[:, 2] - low) / max(high - low, 1e-9)
        still = self.skeletons.BoneMotions(ends[:2], ends[:2], np.tile(np.eye(3), (2, 1, 1)))
        match = type("Match", (), {"sides": [1.0, 2.0]})()
        rest = vertices if pose is None else 1.1 * vertices
        across = np.tile([1.0, 0, 0], (2, 1))
        return self.rigged(rest, bones, still, across, np.column_stack([1 - share, share]), np.ones(2), match, {}, [])

    def remove_rig(self):
        self.op(bpy.ops.object.canonical_form_rig_clear)
        assert self.read_rig(self.obj.data) is None

    def change_armature(self):
        self._object_mode()
        for armature in [each for each in bpy.data.objects if each.type == "ARMATURE"]:
            change = self.chance.randrange(4)
            if change == 0:
                bpy.data.objects.remove(armature)
            elif change == 1:
                armature.name = "Rig of mine"
            elif change == 2:
                armature.pose.bones[0].keyframe_insert("location", frame=3)
            elif self.hat is not None:
                self.hat.parent = armature
        bpy.context.view_layer.update()
