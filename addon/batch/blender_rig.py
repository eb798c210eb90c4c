"""A rig for the meshes of a file in Blender: fitted, written with them; a rigged character lends its bones."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..blender.rigging.kept_rest import keep_rest
from ..blender.rigging.rig_reading import read_rig_source
from ..blender.rigging.rig_task import RigTask
from ..core.run.monitor import Progress
from .lines import Line
from .rigged_files import largest_of, opened, remove_all_but, written
from .wanted import Wanted


def rig_meshes(path: Path, donor: Path | None, target: Path, wanted: Wanted, progress: Progress | None) -> Line:
    """Give the meshes of a file an armature, write them, and return what was done. `donor`: None for the mannequin."""
    objects, warnings = opened(path, wanted)
    own = set(bpy.data.objects)
    source = None
    if donor is not None:
        lender = largest_of(donor)
        bpy.context.view_layer.update()
        source = read_rig_source(lender)
        remove_all_but(own, objects)
    if wanted.rigify and "rigify" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="rigify")
    task = RigTask(
        objects,
        source,
        wanted.settings,
        wanted.rest,
        naming=wanted.naming,
        rigify=wanted.rigify,
        side=wanted.side,
        anyway=wanted.anyway,
    )
    task.compute(progress)
    task.write()
    if wanted.format != "blend":  # what other programs show of several keys differs
        for obj in objects:
            keep_rest(obj)
    warnings += written(objects, path, target, wanted)
    figures = {"objects": [obj.name for obj in objects], "armature": task.armature, "bones": task.confidence}
    return {"object": objects[0].name, **figures, "sides": task.sides, "warnings": [*task.warnings, *warnings]}
