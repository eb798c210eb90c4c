"""Reads meshes as arrays, or says why they cannot be used, and finds them again later."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import CanonicalFormError
from .records import fingerprint, named_key, record_of

if TYPE_CHECKING:
    from ..core.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Reading:
    """The arrays of one object, and what it takes to know it again after a while.

    Attributes
    ----------
    name : str
        Name of the object.
    uid : int
        Blender's number of the object in this session.
    vertices : (n, 3) ndarray of float
        Positions in the mesh's own space.
    faces : (m, 3) ndarray of int
        Triangles.
    print : str
        Fingerprint of positions and triangles of the mesh itself.
    deformed : bool
        Whether the vertices are those that modifiers and other keys show.
    """

    name: str
    uid: int
    vertices: FloatArray
    faces: IntArray
    print: str
    deformed: bool = False


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Say why an object cannot be given a canonical form, before anything is read or computed.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object, usually the active one.

    Returns
    -------
    str or None
        A sentence that says what to do, or None if the object can be used.
    """
    if obj is None:
        return "Select a mesh object first."
    if obj.type != "MESH":
        return f"{obj.name} is not a mesh. Convert it first (Object > Convert > Mesh)."
    mesh = obj.data
    if obj.library is not None or mesh.library is not None or mesh.override_library is not None:
        return f"{mesh.name} is linked from another file. Make it local first (Object > Relations > Make Local)."
    if not mesh.is_editable:
        return f"{mesh.name} cannot be edited. Make it local first (Object > Relations > Make Local)."
    keys = mesh.shape_keys
    if keys is not None and keys.library is not None:
        return f"The shape keys of {mesh.name} are linked from another file. Make them local first."
    if keys is not None and not keys.use_relative:
        return f"The shape keys of {mesh.name} are absolute. Tick Relative in the Shape Keys panel first."
    key = named_key(mesh) if keys is not None else None
    if key is not None and key.lock_shape:
        return f"The shape key {key.name} is locked. Unlock it in the Shape Keys panel first."
    if obj.mode != "OBJECT" and obj != bpy.context.view_layer.objects.active:
        return f"{obj.name} is not the active object. Make it active, or leave its mode, and run again."
    if obj.mode != "EDIT" and mesh.is_editmode:
        return f"{mesh.name} is being edited through another object. Leave Edit Mode there first."
    if obj.mode == "OBJECT" and not mesh.polygons:  # in Edit Mode the mesh may not know its faces yet
        return f"{mesh.name} has no faces. Choose a mesh with a surface."
    return None


def read_mesh(mesh: bpy.types.Mesh) -> tuple[FloatArray, IntArray]:
    """Read the rest shape of a mesh: the Basis where there are shape keys, n-gons as triangles.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its object in Object Mode.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions in the mesh's own space.
    faces : (m, 3) ndarray of int
        Triangles.
    """
    return _rest(mesh).reshape(-1, 3).astype(np.float64), _triangles(mesh)


def read_object(obj: bpy.types.Object, deformed: bool = False) -> Reading:
    """Read an object for a computation that takes a while.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    deformed : bool
        Read what modifiers, pose and shape keys show at the current frame, not the mesh itself.

    Returns
    -------
    Reading
        Its arrays.
    """
    vertices, faces = read_mesh(obj.data)
    mark = _mesh_print(obj.data)
    if deformed:
        with without_result(obj.data):
            vertices, faces = read_shown(obj)
    return Reading(obj.name, obj.session_uid, vertices, faces, mark, deformed)


def read_shown(obj: bpy.types.Object) -> tuple[FloatArray, IntArray]:
    """Read the mesh that modifiers, pose and shape keys show at the current frame.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions in the object's own space.
    faces : (m, 3) ndarray of int
        Triangles.

    Raises
    ------
    CanonicalFormError
        If Blender does not evaluate the object, since it is switched off in the views.
    """
    graph = bpy.context.evaluated_depsgraph_get()
    shown = obj.evaluated_get(graph)
    if shown.original == shown or obj.name not in graph.objects:
        raise CanonicalFormError(
            f"{obj.name} is switched off in the views, so nothing is shown. Switch it on, or set Mesh to Base Mesh."
        )
    mesh = shown.to_mesh()
    try:
        vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
        mesh.vertices.foreach_get("co", vertices)
        return vertices.reshape(-1, 3).astype(np.float64), _triangles(mesh)
    finally:
        shown.to_mesh_clear()


def selected_vertices(mesh: bpy.types.Mesh) -> IntArray:
    """List the selected vertices of a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (s,) ndarray of int
        Vertex indices.
    """
    chosen = np.empty(len(mesh.vertices), dtype=bool)
    mesh.vertices.foreach_get("select", chosen)
    return np.flatnonzero(chosen)


def found_again(reading: Reading) -> bpy.types.Object:
    """Find the object of a reading, unchanged, to write its result.

    Parameters
    ----------
    reading : Reading
        What was read before the computation.

    Returns
    -------
    bpy.types.Object
        The object.

    Raises
    ------
    CanonicalFormError
        If it was deleted, renamed, put into a state that cannot be written to, or its mesh was changed.
    """
    obj = bpy.data.objects.get(reading.name)
    if obj is None or obj.session_uid != reading.uid or not obj.users_scene:
        raise CanonicalFormError(
            f"{reading.name} was deleted or renamed while its form was computed. Nothing was written; run again."
        )
    reason = refusal(obj)
    if reason is not None:
        raise CanonicalFormError(f"{reason} Nothing was written.")
    return obj


def require_unchanged(obj: bpy.types.Object, reading: Reading) -> None:
    """Refuse to write a result to a mesh that is not the one it was computed from.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    reading : Reading
        What was read before the computation.

    Raises
    ------
    CanonicalFormError
        If its vertices or faces are others.
    """
    same = _mesh_print(obj.data) == reading.print
    if same and reading.deformed:
        with without_result(obj.data):
            vertices, faces = read_shown(obj)
        same = np.array_equal(vertices, reading.vertices) and np.array_equal(faces, reading.faces)
    if not same:
        raise CanonicalFormError(
            f"{reading.name} was edited while its form was computed. Nothing was written; run again."
        )


@contextmanager
def object_mode(obj: bpy.types.Object) -> Iterator[None]:
    """Be in Object Mode for a while and go back, whatever happens.

    Parameters
    ----------
    obj : bpy.types.Object
        The object; the active one, if it is in another mode.

    Yields
    ------
    None
        Control, with the object in Object Mode.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    mode = obj.mode
    if mode == "OBJECT":
        yield
        return
    if not obj.visible_get():
        raise CanonicalFormError(
            f"{obj.name} is hidden and in another mode. Show it, or leave its mode, and run again."
        )
    layer = bpy.context.view_layer
    together = [other for other in layer.objects if other.mode == mode]  # several objects may be edited at once
    selected = [other for other in layer.objects if other.select_get()]
    try:
        bpy.ops.object.mode_set(mode="OBJECT")
    except RuntimeError as error:
        raise CanonicalFormError(f"{obj.name} cannot leave its mode. Switch to Object Mode and run again.") from error
    try:
        yield
    finally:
        if mode == "EDIT":
            for other in layer.objects:
                other.select_set(other in together)
        bpy.ops.object.mode_set(mode=mode)
        if mode == "EDIT":
            for other in layer.objects:
                other.select_set(other in selected)


@contextmanager
def without_result(mesh: bpy.types.Mesh) -> Iterator[None]:
    """Leave the keys of an earlier run out of what is shown: a form is made of the pose, not of a form.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Yields
    ------
    None
        Control, while they are muted.
    """
    record = record_of(mesh)
    names = [] if record is None else [*record["key"], *record.get("between", {})]
    keys = [
        mesh.shape_keys.key_blocks[name] for name in names if mesh.shape_keys and name in mesh.shape_keys.key_blocks
    ]
    muted = [key.mute for key in keys]
    try:
        for key in keys:
            key.mute = True
        bpy.context.view_layer.update()
        yield
    finally:
        for key, mute in zip(keys, muted, strict=True):
            key.mute = mute
        bpy.context.view_layer.update()


def _rest(mesh: bpy.types.Mesh) -> np.ndarray:
    points = mesh.vertices if mesh.shape_keys is None else mesh.shape_keys.reference_key.data
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    points.foreach_get("co", vertices)
    return vertices


def _mesh_print(mesh: bpy.types.Mesh) -> str:
    """Hash positions and polygons, without the triangles between, which take longer."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", corners)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return fingerprint(_rest(mesh), corners, starts)


def _triangles(mesh: bpy.types.Mesh) -> IntArray:
    mesh.calc_loop_triangles()
    faces = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    return faces.reshape(-1, 3).astype(np.int64)
