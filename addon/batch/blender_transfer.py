"""A transfer between two files in Blender: the mesh of one is brought into the other, and removed again."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from ..blender.files.face_indices import require_whole_faces
from ..blender.files.kinds_of_files import PLAIN
from ..blender.files.outside_references import pictures_not_held
from ..blender.files.reading_files import add_meshes, open_meshes, scripts_left_off
from ..blender.files.writing_files import Shown, save_blend, save_forms
from ..blender.objects.mesh_reading import read_mesh, refusal
from ..blender.results.kept_rigs import movers_of, with_rigs
from ..blender.transfer.transfer_task import TransferTask
from ..core import CanonicalFormError
from ..core.run.monitor import Progress
from .file_space import in_file_space, is_mirrored
from .lines import LEFT_OFF, Line, pictures_told
from .wanted import KINDS, Wanted


def transfer_between(path: Path, donor: Path, target: Path, wanted: Wanted, progress: Progress | None) -> Line:
    """Transfer data from the largest mesh of a file to those of another, write it, and return what was done."""
    if path.samefile(donor):
        raise CanonicalFormError("This file is the reference itself.")
    objects = open_meshes(path, wanted.objects, trusted=wanted.trusted, kept=wanted.format == "blend")
    warnings = [LEFT_OFF] if scripts_left_off(path) else []
    require_whole_faces(objects)
    for obj in objects:
        reason = refusal(obj)
        if reason is not None:
            raise CanonicalFormError(reason)
    if len(objects) > 1 and f".{wanted.format}" in PLAIN:
        raise CanonicalFormError(f".{wanted.format} holds one object. Choose blend, glb, fbx or usdc.")
    own = set(bpy.data.objects)
    source = max(add_meshes(donor), key=lambda each: len(each.data.vertices))
    task = TransferTask(objects, source, {KINDS[name] for name in wanted.kinds}, wanted.settings, wanted.side)
    task.compute(progress)
    task.write()
    bpy.context.view_layer.update()
    needed = {mover for obj in objects for mover in movers_of(obj)}
    name, figures = source.name, {"objects": [obj.name for obj in objects], "transferred": task.told}
    bpy.data.batch_remove([obj for obj in bpy.data.objects if obj not in own and obj not in needed])
    if wanted.format == "blend":
        save_blend(target, wanted.mark)
    else:
        left_out = _exported(objects, target, wanted, path.parent)
        absent = [] if wanted.format in ("ply", "off") else pictures_not_held(objects, wanted.format)
        warnings += pictures_told(left_out, absent)
    return {"object": objects[0].name, **figures, "from": name, "warnings": [*task.warnings, *warnings]}


def _exported(objects: list[bpy.types.Object], target: Path, wanted: Wanted, pictures: Path) -> list[str]:
    """Write the objects with their rigs; return the names of the pictures that were left out."""
    unit = bpy.context.scene.unit_settings
    shown = []
    for obj in objects:
        placement = np.array(obj.matrix_world)
        points = in_file_space(read_mesh(obj.data)[0], placement, wanted, unit.scale_length)
        shown.append(Shown(obj, points, mirrored=is_mirrored(placement, wanted)))
    with with_rigs(objects, 0.0, posed=False) as rigs:
        return save_forms(target, shown, wanted.mark, pictures=None if wanted.trusted else pictures, rigs=rigs)
