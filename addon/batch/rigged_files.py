"""Files whose meshes get data or a rig from another, read into Blender, and written with what moves them."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import bpy
import numpy as np

from ..blender.files.face_indices import require_whole_faces
from ..blender.files.kinds_of_files import PLAIN
from ..blender.files.outside_references import pictures_not_held
from ..blender.files.reading_files import add_meshes, open_meshes, scripts_left_off
from ..blender.files.writing_files import Shown, save_blend, save_forms
from ..blender.objects.mesh_reading import read_mesh, refusal
from ..blender.objects.rest_reading import moved_by, rigs_of
from ..blender.results.kept_rigs import movers_of, with_rigs
from ..core import CanonicalFormError
from .file_space import in_file_space, is_mirrored
from .lines import LEFT_OFF, pictures_told
from .wanted import Wanted


def opened(path: Path, wanted: Wanted) -> tuple[list[bpy.types.Object], list[str]]:
    """Open a file, and return its meshes, all of them usable, with warnings."""
    objects = open_meshes(path, wanted.objects, trusted=wanted.trusted, kept=wanted.format == "blend")
    require_whole_faces(objects)
    for obj in objects:
        reason = refusal(obj)
        if reason is not None:
            raise CanonicalFormError(reason)
    if len(objects) > 1 and f".{wanted.format}" in PLAIN:
        raise CanonicalFormError(f".{wanted.format} holds one object. Choose blend, glb, fbx or usdc.")
    return objects, [LEFT_OFF] if scripts_left_off(path) else []


def largest_of(donor: Path) -> bpy.types.Object:
    """Bring the objects of another file into the open one, and return its largest mesh."""
    return max(add_meshes(donor), key=lambda each: len(each.data.vertices))


def character_of(mesh: bpy.types.Object) -> bpy.types.Object:
    """Return the armature that alone moves a mesh and others, and stands for them; the mesh if there is none."""
    bpy.context.view_layer.update()
    rig = next(iter(rigs_of(mesh)), None)
    meshes = [] if rig is None else moved_by(rig)
    return rig if rig is not None and mesh in meshes and len(meshes) > 1 else mesh


def remove_all_but(own: Collection[bpy.types.Object], objects: list[bpy.types.Object]) -> None:
    """Remove the objects of another file, but for what moves those that are written. `own`: of this file."""
    bpy.context.view_layer.update()
    needed = {mover for obj in objects for mover in movers_of(obj)}
    bpy.data.batch_remove([obj for obj in bpy.data.objects if obj not in own and obj not in needed])


def written(objects: list[bpy.types.Object], path: Path, target: Path, wanted: Wanted) -> list[str]:
    """Write objects with their rigs, and return warnings. `path`: the file that they come from."""
    if wanted.format == "blend":
        save_blend(target, wanted.mark)
        return []
    unit = bpy.context.scene.unit_settings
    shown = []
    for obj in objects:
        placement = np.array(obj.matrix_world)
        points = in_file_space(read_mesh(obj.data)[0], placement, wanted, unit.scale_length)
        shown.append(Shown(obj, points, mirrored=is_mirrored(placement, wanted)))
    pictures = None if wanted.trusted else path.parent
    with with_rigs(objects, 0.0, posed=False) as rigs:
        left_out = save_forms(target, shown, wanted.mark, pictures=pictures, rigs=rigs)
    absent = [] if wanted.format in ("ply", "off") else pictures_not_held(objects, wanted.format)
    return pictures_told(left_out, absent)
