"""Opens mesh files in Blender, of every kind that it imports."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy

from ...core import InvalidMeshError
from .file_access import require_named, require_readable
from .kinds_of_files import IMPORTERS, READ
from .local_copies import copy_foreign_meshes
from .misread_files import read_instead
from .off_format import read_off
from .outside_references import require_own_buffers

_BONE_SHAPES = "glTF_not_exported"  # collection in which the .glb importer puts the custom shapes of bones
_KINDS = [  # collections of bpy.data that an imported file may fill
    "actions",
    "armatures",
    "cache_files",
    "cameras",
    "collections",
    "curves",
    "grease_pencils",
    "hair_curves",
    "images",
    "lattices",
    "lightprobes",
    "lights",
    "linestyles",
    "masks",
    "materials",
    "meshes",
    "metaballs",
    "movieclips",
    "node_groups",
    "objects",
    "paint_curves",
    "palettes",
    "particles",
    "pointclouds",
    "sounds",
    "speakers",
    "texts",
    "textures",
    "volumes",
    "worlds",
]


def open_meshes(
    path: Path,
    names: Sequence[str] = (),
    *,
    shared: bool = True,
    trusted: bool = False,
    kept: bool = True,
    shown: bool = False,
) -> list[bpy.types.Object]:
    """Open a file in place of the current one and return its mesh objects.

    Parameters
    ----------
    path : Path
        A file of a kind in `kinds_of_files.READ`.
    names : sequence of str
        Names of the required objects; empty for all.
    shared : bool
        Whether to return only the first of several objects that share a mesh.
    trusted : bool
        Whether to trust the file: scripts and Python drivers of a trusted .blend file run, and files outside its folder
        that it refers to may be included in the results.
    kept : bool
        Whether results are to be written into the file. If not, meshes that are linked, overridden or in collection
        instances are copied, since they cannot be written to.
    shown : bool
        Whether meshes count whose faces are made by modifiers.

    Returns
    -------
    list of bpy.types.Object
        The objects, sorted by name.

    Raises
    ------
    InvalidMeshError
        If the file does not exist, is of a kind that this Blender does not import, cannot be read or has no mesh.
    """
    _require_kind(path)
    try:
        with quiet():
            if path.suffix.lower() == ".blend":
                bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=trusted)
                if not trusted:
                    bpy.data.use_autopack = False  # saving would pack every file that it refers to
            else:
                if not trusted and path.suffix.lower() in (".glb", ".gltf"):
                    require_own_buffers(path)
                _empty()
                _import(path)
    except RuntimeError as error:
        raise InvalidMeshError(f"Blender cannot read {path.name}: {last_line(error)}") from error
    if not kept:
        copy_foreign_meshes()
    found: dict[bpy.types.ID, bpy.types.Object] = {}
    there = set()
    for obj in sorted(bpy.data.objects, key=lambda each: each.name):
        replaced = not kept and obj.library is not None  # by a copy
        visible = not replaced and obj.users_scene and not _is_bone_shape(obj)
        if obj.type == "MESH" and visible and (not names or obj.name in names) and _has_faces(obj, shown):
            there.add(obj.name)
            found.setdefault(obj.data if shared else obj, obj)
    require_named(path, names, there)
    if not found:
        instances = kept and any(obj.instance_type == "COLLECTION" for obj in bpy.context.scene.objects)
        remedy = " but in collection instances. Choose another --format than blend" if instances else ""
        raise InvalidMeshError(f"{path.name} holds no mesh with faces{remedy}.")
    return list(found.values())


def _require_kind(path: Path) -> None:
    """Require a file of a kind that can be read."""
    require_readable(path)
    if path.suffix.lower() not in READ:
        raise InvalidMeshError(f"{path.name} is not of a kind that can be read: {', '.join(READ)}.")


def _is_bone_shape(obj: bpy.types.Object) -> bool:
    """Return whether an object shows a bone, as the .glb importer adds them."""
    return any(each.name == _BONE_SHAPES for each in obj.users_collection)


def _has_faces(obj: bpy.types.Object, shown: bool) -> bool:
    """Return whether a mesh has faces, or its modifiers make some."""
    if len(obj.data.polygons) or not (shown and obj.modifiers):
        return len(obj.data.polygons) > 0
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return evaluated.type == "MESH" and len(evaluated.data.polygons) > 0


def add_meshes(path: Path) -> list[bpy.types.Object]:
    """Bring the objects of a file into the open one, and return its mesh objects.

    Parameters
    ----------
    path : Path
        A file of a kind in `kinds_of_files.READ`.

    Returns
    -------
    list of bpy.types.Object
        The objects, which may have other names than in their file.

    Raises
    ------
    InvalidMeshError
        As in `open_meshes`.
    """
    _require_kind(path)
    kind = path.suffix.lower()
    before = set(bpy.data.objects)
    try:
        with quiet():
            if kind == ".blend":
                with bpy.data.libraries.load(str(path)) as (there, here):
                    here.objects = list(there.objects)
                for obj in here.objects:
                    if obj is not None:
                        bpy.context.scene.collection.objects.link(obj)
            else:
                if kind in (".glb", ".gltf"):
                    require_own_buffers(path)
                _import(path)
    except (OSError, RuntimeError) as error:
        raise InvalidMeshError(f"Blender cannot read {path.name}: {last_line(error)}") from error
    bpy.context.view_layer.update()
    found = [
        obj
        for obj in sorted(bpy.data.objects, key=lambda each: each.name)
        if obj not in before and obj.type == "MESH" and _has_faces(obj, False) and not _is_bone_shape(obj)
    ]
    if not found:
        raise InvalidMeshError(f"{path.name} holds no mesh with faces.")
    return found


def scripts_left_off(path: Path) -> bool:
    """Return whether Blender blocked scripts or drivers of the open file because it is not trusted.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    bool
        True if Blender blocked any.
    """
    return path.suffix.lower() == ".blend" and bool(bpy.app.autoexec_fail)  # other kinds keep the last value


def last_line(error: Exception) -> str:
    r"""Return the last line of a Blender error, which is the actual message when the error contains a traceback.

    Parameters
    ----------
    error : Exception
        The error.

    Returns
    -------
    str
        The message.

    Examples
    --------
    >>> last_line(RuntimeError("Error: Python: Traceback:\n  File x\nOSError: full\nLocation: y"))
    'OSError: full'
    """
    reason = str(error).strip()
    if "Traceback" not in reason:
        return reason
    return next((line for line in reversed(reason.splitlines()) if line and line[0] not in " L"), reason)


@contextmanager
def quiet() -> Iterator[None]:
    """Discard what Blender prints while it reads or writes a file; it raises its errors as well.

    Yields
    ------
    None
        Standard output and standard error are discarded until the end of the block.
    """
    sys.stderr.flush()
    terminals = {number: os.dup(number) for number in (1, 2)}
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for number in terminals:
            os.dup2(nowhere, number)
        os.close(nowhere)
        yield
    finally:
        _flush()
        for number, terminal in terminals.items():
            os.dup2(terminal, number)
            os.close(terminal)


def _flush() -> None:
    """Flush the output that Blender has printed through the C library, where the library can be reached."""
    if sys.platform != "win32":
        import ctypes

        ctypes.CDLL(None).fflush(None)


def _empty() -> None:
    """Remove all data of the open file; loading an empty file instead would disable extensions."""
    fresh = bpy.data.scenes.new("Scene")
    for window in bpy.context.window_manager.windows:
        window.scene = fresh
    old = [scene for scene in bpy.data.scenes if scene != fresh]
    for kind in _KINDS:
        old += list(getattr(bpy.data, kind, []))
    bpy.data.batch_remove(old)
    fresh.name = "Scene"


def importer(kind: str) -> Callable[..., set[str]] | None:
    """Return the operator with which this Blender imports a kind of file.

    Parameters
    ----------
    kind : str
        A file name extension in lower case, with its dot.

    Returns
    -------
    callable or None
        The operator; None if this Blender was built without it or its add-on is disabled.
    """
    for name in IMPORTERS[kind]:
        group, operator = name.split(".")
        if operator in dir(getattr(bpy.ops, group)):
            return getattr(getattr(bpy.ops, group), operator)  # type: ignore[no-any-return]
    return None


def _import(path: Path) -> None:
    """Import a file into the open, empty file."""
    kind = path.suffix.lower()
    try:
        read = read_off(path) if kind == ".off" else read_instead(path)
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        raise InvalidMeshError(f"{path.name} is damaged or not a {kind} file.") from error
    if read is not None:
        mesh = bpy.data.meshes.new(path.stem)
        mesh.from_pydata(read.vertices.tolist(), [], read.polygons)
        obj = bpy.data.objects.new(path.stem, mesh)
        if kind == ".obj":  # as Blender's importer lays it
            obj.rotation_euler.x = math.pi / 2
        bpy.context.scene.collection.objects.link(obj)
        bpy.context.view_layer.update()
        return
    operator = importer(kind)
    if operator is None:
        raise InvalidMeshError(
            f"This Blender ({bpy.app.version_string}) has no importer for {kind} ({' or '.join(IMPORTERS[kind])}). "
            "Use another Blender, or another kind of file."
        )
    operator(filepath=str(path))
