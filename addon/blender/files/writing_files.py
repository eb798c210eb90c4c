"""Writes forms to files of many kinds; a file is replaced only when the new one is complete."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import bpy
import numpy as np

from ...core import InvalidMeshError
from ...core.numerics.arrays import FloatArray, IntArray
from ..mesh_items.key_removal import remove_all_keys
from .kinds_of_files import EXPORTERS
from .obj_format import word
from .outside_references import without_foreign_pictures
from .plain_files import write_lines, write_plain
from .polygon_mesh import PolygonMesh
from .reading_files import last_line, quiet
from .replacing_files import replaced

_USD_MAGIC, _ZSTD_MAGIC, _ZSTD_END = b"PXR-USDC", b"\x28\xb5\x2f\xfd", b"\xb1\xea\x92\x8f"
_PICTURES_STAY = {"export_textures_mode": "KEEP", "export_textures": False}  # copies with the same name would collide
_TOLD: dict[str, dict[str, Any]] = {  # options of the exporters: write only the selection, without animation
    "glb": {
        "use_selection": True,
        "use_active_scene": True,
        "export_format": "GLB",
        "export_animations": False,
        "export_vertex_color": "ACTIVE",
    },
    "fbx": {"use_selection": True, "object_types": {"MESH"}, "bake_anim": False},
    "usdc": {"selected_objects_only": True, "export_animation": False},
}
_OWN_MTL = "# By Canonical Form"  # first line of a .mtl that a later run may replace


class Shown(NamedTuple):
    """An object with its form, to be written to a file.

    Attributes
    ----------
    obj : bpy.types.Object
        The object whose polygons, UV maps and materials are written.
    form : (n, 3) ndarray of float
        Positions of the vertices of its mesh, in local space.
    patches : (n,) ndarray of int
        Patch of each vertex; -1 for none.
    colours : (n, 4) ndarray of float
        Colour of each vertex, by patch.
    """

    obj: bpy.types.Object
    form: FloatArray
    patches: IntArray
    colours: np.ndarray


def save_blend(path: Path, mark: str = "") -> None:
    """Save the current file as a .blend file.

    Parameters
    ----------
    path : Path
        The file; it is replaced atomically when the new one is complete.
    mark : str
        As in `replaced`.
    """

    def write(partial: Path) -> None:
        with quiet():
            bpy.ops.wm.save_as_mainfile(filepath=str(partial), copy=True, compress=True)
        _require_whole(partial)

    replaced(path, write, mark)


def save_forms(path: Path, shown: Sequence[Shown], mark: str = "", *, pictures: Path | None = None) -> list[str]:
    """Write forms with the polygons, UV maps and materials of their meshes.

    .obj, .ply and .off files hold one form, in local space and in the vertex order of the mesh; .obj stores the patches
    as groups, .ply as colours and without UV map, .off positions and polygons only. Blender writes the other kinds, in
    world space, with the patches as colours.

    Parameters
    ----------
    path : Path
        The file, of a kind in `kinds_of_files.WRITTEN` other than .blend; it is replaced atomically when the new one is
        complete.
    shown : sequence of Shown
        The forms.
    mark : str
        As in `replaced`.
    pictures : Path, optional
        Folder from which images may be included in a .glb file; all images if omitted.

    Returns
    -------
    list of str
        Names of the images that were left out.

    Raises
    ------
    InvalidMeshError
        If the kind cannot store the mesh, or this Blender does not export it.
    """
    kind = path.suffix[1:]
    if kind in EXPORTERS:
        with without_foreign_pictures([each.obj for each in shown], pictures if kind == "glb" else None) as left_out:
            replaced(path, lambda partial: _export(partial, kind, shown), mark)
        return left_out
    (one,) = shown
    mesh = _polygon_mesh(one)
    if kind == "obj" and any(mesh.materials):
        beside = _free_mtl(path)
        used = [slot.material for slot in one.obj.material_slots if slot.material is not None]
        write_lines(beside, [_OWN_MTL, *(line for material in used for line in _as_mtl(material))], mark)
        mesh = mesh._replace(library=beside.name)
    write_plain(path, mesh, mark)
    return []


def _free_mtl(path: Path) -> Path:
    """Choose a name for the .mtl file that overwrites none but our own: an existing one may belong to the input."""
    number, found = 1, path.with_suffix(".mtl")
    while found.exists() and not _starts_with(found, _OWN_MTL):
        number += 1
        found = path.with_name(f"{path.stem}-{number}.mtl")
    return found


def _starts_with(path: Path, text: str) -> bool:
    """Return whether a file starts with a text."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(text)) == text.encode()


def _export(path: Path, kind: str, shown: Sequence[Shown]) -> None:
    """Export copies of the objects, shaped as their forms, with Blender's exporter."""
    group, operator = EXPORTERS[kind].split(".")
    if operator not in dir(getattr(bpy.ops, group)):
        raise InvalidMeshError(f"This Blender ({bpy.app.version_string}) does not write .{kind}. Choose another kind.")
    for obj in bpy.context.view_layer.objects:
        obj.select_set(False)
    write = getattr(getattr(bpy.ops, group), operator)
    known = write.get_rna_type().properties
    told = _TOLD[kind] | {name: value for name, value in _PICTURES_STAY.items() if name in known}
    names = [each.obj.name for each in shown]
    for each in shown:
        each.obj.name = "Original"  # the copies have the names, and Blender would number them
    copies = [_copy(each, name) for each, name in zip(shown, names, strict=True)]
    try:
        with quiet():
            write(filepath=str(path), **told)
    except RuntimeError as error:
        raise InvalidMeshError(f"Blender cannot write {path.suffix}: {last_line(error)}") from error
    finally:
        bpy.data.batch_remove([*copies, *(each.data for each in copies)])
        for each, name in zip(shown, names, strict=True):
            each.obj.name = name
    _require_whole(path)


def _require_whole(path: Path) -> None:
    """Reject a truncated file: on a full disk Blender writes partial .blend and .usdc files without an error."""
    whole = path.is_file() and path.stat().st_size > 0
    if whole and path.suffix in (".blend", ".usdc"):
        with path.open("rb") as file:
            head = file.read(24)
            size = file.seek(0, os.SEEK_END)
            if head[:8] == _USD_MAGIC:  # then the offset of the table of contents, which is at the end
                whole = int.from_bytes(head[16:24], "little") < size
            elif head[:4] == _ZSTD_MAGIC:  # the compressed file ends with a table of its frames
                file.seek(max(size - 4, 0))
                whole = file.read(4) == _ZSTD_END
    if not whole:
        raise OSError(f"Blender could not write all of the {path.suffix} file. Is the disk full?")


def _copy(shown: Shown, name: str) -> bpy.types.Object:
    """Add a selected copy of an object, shaped as its form, without modifiers, shape keys, parent and animation."""
    mesh = shown.obj.data.copy()
    copy = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(copy)
    if mesh.shape_keys is not None:
        remove_all_keys(copy)
    mesh.vertices.foreach_set("co", shown.form.astype(np.float32).ravel())
    mesh.update()
    copy.matrix_world = shown.obj.matrix_world
    if not np.allclose(copy.matrix_basis, shown.obj.matrix_world, atol=1e-6):  # sheared, as no file format holds it
        mesh.transform(copy.matrix_basis.inverted_safe() @ shown.obj.matrix_world)
    for own, slot in zip(copy.material_slots, shown.obj.material_slots, strict=False):
        own.material = slot.material
    copy.select_set(True)
    bpy.context.view_layer.objects.active = copy
    return copy


def _polygon_mesh(shown: Shown) -> PolygonMesh:
    """Read what a text file holds of an object, shaped as its form."""
    mesh = shown.obj.data
    corner_uv = None
    if mesh.uv_layers.active is not None:
        corner_uv = np.empty(2 * len(mesh.loops), dtype=np.float32)
        mesh.uv_layers.active.data.foreach_get("uv", corner_uv)
        corner_uv = corner_uv.reshape(-1, 2)
    return PolygonMesh(
        shown.form,
        [list(polygon.vertices) for polygon in mesh.polygons],
        shown.patches,
        shown.colours,
        corner_uv,
        [slot.material.name if slot.material else "" for slot in shown.obj.material_slots],
        [polygon.material_index for polygon in mesh.polygons],
    )


def _as_mtl(material: bpy.types.Material) -> list[str]:
    """Return the .mtl lines for a material: its name, colour and first image."""
    red, green, blue, alpha = material.diffuse_color
    lines = [f"newmtl {word(material.name)}", f"Kd {red:.6g} {green:.6g} {blue:.6g}", f"d {alpha:.6g}"]
    nodes = material.node_tree.nodes if material.node_tree is not None else ()
    images = [node.image for node in nodes if node.type == "TEX_IMAGE" and node.image is not None]
    if images and images[0].filepath:
        lines.append(f"map_Kd {bpy.path.abspath(images[0].filepath)}")
    return [*lines, ""]
