"""Writes forms to files of many kinds; a file is replaced only when the new one is complete."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import bpy
import numpy as np

from ...core import InvalidMeshError
from ...core.numerics.arrays import FloatArray, IntArray
from ..mesh_items.colour_attributes import add_colours
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
        "export_attributes": True,
        "export_extras": True,
    },
    "fbx": {
        "use_selection": True,
        "object_types": {"MESH"},
        "bake_anim": False,
        "use_custom_props": True,
        "path_mode": "COPY",
        "embed_textures": True,
    },
    "usdc": {"selected_objects_only": True, "export_animation": False},
    "usdz": {"selected_objects_only": True, "export_animation": False},
}
_WITH_RIG: dict[str, dict[str, Any]] = {  # the armature as it stands, its weights, and keys that no modifier has eaten
    "glb": {"export_apply": False, "export_skins": True, "export_morph": True, "export_rest_position_armature": False},
    "fbx": {"object_types": {"MESH", "ARMATURE", "EMPTY"}, "use_mesh_modifiers": False, "add_leaf_bones": False},
    "usdc": {"export_armatures": True, "export_shapekeys": True, "export_animation": True},  # which has the values
    "usdz": {"export_armatures": True, "export_shapekeys": True, "export_animation": True},
}
_HOLDS_PICTURES = ("glb", "fbx", "usdz")
_OWN_MTL = "# By Canonical Form"  # first line of a .mtl that a later run may replace


class Shown(NamedTuple):
    """An object that is written to a file.

    Attributes
    ----------
    obj : bpy.types.Object
        The object, shaped as its form.
    form : (n, 3) ndarray of float
        Positions of its vertices in the axes of a text file.
    patches : (n,) ndarray of int or None
        Patch of each vertex, for the groups of an .obj; -1 for none.
    colours : (n, 4) ndarray of float or None
        Colours of its vertices to add, such as those of the patches; None to leave them as they are.
    named : str
        Name of these colours.
    mirrored : bool
        Whether the axes of a text file show faces from behind.
    """

    obj: bpy.types.Object
    form: FloatArray
    patches: IntArray | None = None
    colours: np.ndarray | None = None
    named: str = ""
    mirrored: bool = False


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


def save_forms(
    path: Path,
    shown: Sequence[Shown],
    mark: str = "",
    *,
    pictures: Path | None = None,
    rigs: Sequence[bpy.types.Object] = (),
) -> list[str]:
    """Write objects that are shaped as their forms.

    .obj, .ply and .off files hold one form, in the vertex order of the mesh: .obj with UV map,
    materials and colours, .ply with colours, .off positions and polygons only. Blender writes the other kinds, in
    world space. Viewers multiply the colours of a .glb into its texture, so that those of a field are an attribute.

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
        Folder from which images may be included, in kinds that hold them; all images if omitted.
    rigs : sequence of bpy.types.Object
        What is to be written besides: armatures and parents of the objects, which then keep their weights and keys.

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
        with without_foreign_pictures(
            [each.obj for each in shown], pictures if kind in _HOLDS_PICTURES else None
        ) as left_out:
            replaced(path, lambda partial: _export(partial, kind, shown, rigs), mark)
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


def _export(path: Path, kind: str, shown: Sequence[Shown], rigs: Sequence[bpy.types.Object]) -> None:
    """Export objects with Blender's exporter."""
    group, operator = EXPORTERS[kind].split(".")
    if operator not in dir(getattr(bpy.ops, group)):
        raise InvalidMeshError(f"This Blender ({bpy.app.version_string}) does not write .{kind}. Choose another kind.")
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in rigs)
    for each in shown:
        each.obj.select_set(True)
        bpy.context.view_layer.objects.active = each.obj
        if each.colours is not None:
            _show(each.obj, each.colours, each.named, kind)
        if rigs and kind.startswith("usd"):
            _animate_keys(each.obj)
    hidden = [obj.name for obj in [*rigs, *(each.obj for each in shown)] if not obj.select_get()]
    if hidden:
        raise InvalidMeshError(f"{', '.join(hidden)} cannot be selected, so that .{kind} would lack it. Show it first.")
    write = getattr(getattr(bpy.ops, group), operator)
    known = write.get_rna_type().properties
    told = dict(_TOLD[kind]) | {
        name: value for name, value in (_WITH_RIG[kind].items() if rigs else ()) if name in known
    }
    if kind == "usdc":
        told |= {name: value for name, value in _PICTURES_STAY.items() if name in known}
    try:
        with quiet(), _this_frame_only(), _textures_alone([each.obj for each in shown] if kind == "fbx" else []):
            write(filepath=str(path), **told)
    except RuntimeError as error:
        raise InvalidMeshError(f"Blender cannot write {path.suffix}: {last_line(error)}") from error
    _require_whole(path)


def _animate_keys(obj: bpy.types.Object) -> None:
    """Keyframe the values of shape keys, which .usd holds as an animation only."""
    keys = obj.data.shape_keys
    if keys is not None and keys.animation_data is None:
        for key in keys.key_blocks:
            if key != keys.reference_key:
                key.keyframe_insert("value")


@contextmanager
def _this_frame_only() -> Iterator[None]:
    """Make the animation of the scene its current frame, for a while."""
    scene = bpy.context.scene
    before = scene.frame_start, scene.frame_end
    try:
        scene.frame_start = scene.frame_end = scene.frame_current
        yield
    finally:
        scene.frame_start, scene.frame_end = before


@contextmanager
def _textures_alone(objects: Sequence[bpy.types.Object]) -> Iterator[None]:
    """Link the first image behind a base colour directly, for a while: .fbx knows no textures times vertex colours."""
    changed = []
    for material in {slot.material for obj in objects for slot in obj.material_slots if slot.material is not None}:
        for node in material.node_tree.nodes if material.node_tree is not None else ():
            colour = node.inputs.get("Base Color") if node.type == "BSDF_PRINCIPLED" else None
            source = colour.links[0].from_socket if colour is not None and colour.is_linked else None
            image = None if source is None or source.node.type == "TEX_IMAGE" else _image_behind(source.node)
            if image is not None:
                changed.append((material.node_tree.links, source, colour))
                material.node_tree.links.new(image.outputs["Color"], colour)
    try:
        yield
    finally:
        for links, source, colour in changed:
            links.new(source, colour)


def _image_behind(node: bpy.types.Node) -> bpy.types.Node | None:
    """Find the first image texture among the nodes that a node depends on."""
    nodes, seen = [node], set()
    while nodes:
        one = nodes.pop(0)
        if one.type == "TEX_IMAGE" and one.image is not None:
            return one
        if one not in seen:
            seen.add(one)
            nodes += [link.from_node for each in one.inputs for link in each.links]
    return None


def _show(obj: bpy.types.Object, colours: np.ndarray, named: str, kind: str) -> None:
    """Add colours to an object."""
    mesh = obj.data
    if kind == "glb":  # as COLOR_0, a viewer would multiply them into the texture
        name = f"_{named.upper().replace(' ', '_')}"
        attribute = mesh.attributes.new(name=name, type="FLOAT_VECTOR", domain="POINT")
        attribute.data.foreach_set("vector", colours[:, :3].astype(np.float32).ravel())
    else:
        attribute = add_colours(obj, named)
        attribute.data.foreach_set("color", colours.astype(np.float32).ravel())
        mesh.color_attributes.active_color = attribute


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


def _polygon_mesh(shown: Shown) -> PolygonMesh:
    """Read what a text file holds of an object, shaped as its form."""
    mesh = shown.obj.data
    corner_uv = None
    if mesh.uv_layers.active is not None:
        corner_uv = np.empty(2 * len(mesh.loops), dtype=np.float32)
        mesh.uv_layers.active.data.foreach_get("uv", corner_uv)
        corner_uv = corner_uv.reshape(-1, 2)
    whole = PolygonMesh(
        shown.form,
        [list(polygon.vertices) for polygon in mesh.polygons],
        shown.patches,
        _own_colours(mesh) if shown.colours is None else shown.colours,
        corner_uv,
        [slot.material.name if slot.material else "" for slot in shown.obj.material_slots],
        [polygon.material_index for polygon in mesh.polygons],
    )
    return whole.turned_over() if shown.mirrored else whole


def _own_colours(mesh: bpy.types.Mesh) -> np.ndarray | None:
    """Return the active colours of a mesh, one a vertex; None if it has none."""
    attribute = mesh.color_attributes.active_color
    if attribute is None or attribute.domain not in ("POINT", "CORNER"):
        return None
    colours = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", colours)
    colours = colours.reshape(-1, 4).astype(np.float64)
    if attribute.domain == "POINT":
        return colours
    vertex = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", vertex)
    count = np.maximum(np.bincount(vertex, minlength=len(mesh.vertices)), 1)
    return np.column_stack([np.bincount(vertex, each, len(mesh.vertices)) / count for each in colours.T])


def _as_mtl(material: bpy.types.Material) -> list[str]:
    """Return the .mtl lines for a material: its name, colour and first image."""
    red, green, blue, alpha = material.diffuse_color
    lines = [f"newmtl {word(material.name)}", f"Kd {red:.6g} {green:.6g} {blue:.6g}", f"d {alpha:.6g}"]
    nodes = material.node_tree.nodes if material.node_tree is not None else ()
    images = [node.image for node in nodes if node.type == "TEX_IMAGE" and node.image is not None]
    if images and images[0].filepath:
        lines.append(f"map_Kd {bpy.path.abspath(images[0].filepath)}")
    return [*lines, ""]
