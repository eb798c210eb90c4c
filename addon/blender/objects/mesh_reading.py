"""Reads meshes as arrays, rejects unusable ones, and checks after a computation that they are unchanged."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError, InvalidMeshError
from ..mesh_items.fingerprints import fingerprint
from ..records.form_key import form_key
from ..words.wording import told
from .mirrors import mirrors_of
from .object_states import muted_results
from .placement import placement_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ...core import Skeleton
    from ...core.mesh.mirroring import Mirror
    from ...core.numerics.arrays import FloatArray, IntArray


class Bones(NamedTuple):
    """The bones that move an object.

    Attributes
    ----------
    rig : str
        Name of the armature object.
    skeleton : Skeleton
        All its bones at rest, in world space.
    weights : (n, b) ndarray of float
        How far each vertex follows each bone.
    rest : (n, 3) ndarray of float
        Positions of the vertices with that armature at rest, in the space of the reading.
    """

    rig: str
    skeleton: Skeleton
    weights: FloatArray
    rest: FloatArray


class Reading(NamedTuple):
    """The arrays of one object, and what identifies the object after a computation.

    Attributes
    ----------
    name : str
        Name of the object.
    session_uid : int
        Blender's identifier of the object in this session.
    vertices : (n, 3) ndarray of float
        Positions in the mesh's local space.
    faces : (m, 3) ndarray of int
        Triangles.
    fingerprint : str
        Fingerprint of positions and polygons of the base mesh.
    deformed : bool
        Whether the vertices are those of the evaluated mesh: with modifiers, pose and shape keys.
    frame : int or None
        The frame of the evaluated mesh.
    placement : (4, 4) ndarray of float
        The transform to the space shared by several objects.
    mirrors : sequence of Mirror
        Mirrors of modifiers; vertices and faces do not include the images.
    rest : (n, 3) ndarray of float or None
        Positions of the vertices with the armature at rest; None if it is not known.
    bones : Bones or None
        The bones that move the object, and it alone; None unless they were asked for, or if they could not be read.
    rig : str
        Name of the armature whose bones were asked for; empty if there is none.
    """

    name: str
    session_uid: int
    vertices: FloatArray
    faces: IntArray
    fingerprint: str
    deformed: bool
    frame: int | None
    placement: FloatArray
    mirrors: Sequence[Mirror]
    rest: FloatArray | None = None
    bones: Bones | None = None
    rig: str = ""


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Return why no canonical form can be computed for an object, before any mesh data is read.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object, usually the active one.

    Returns
    -------
    str or None
        A sentence that names the remedy; None if the object can be used.
    """
    if obj is None:
        return told("Select a mesh object first.")
    if obj.type != "MESH":
        return told("{name} is not a mesh. Convert it first (Object > Convert > Mesh).", name=obj.name)
    mesh = obj.data
    if obj.library is not None or mesh.library is not None or mesh.override_library is not None:
        return told(
            "{name} is linked from another file. Make it local first (Object > Relations > Make Local).", name=mesh.name
        )
    if not mesh.is_editable:
        return told("{name} cannot be edited. Make it local first (Object > Relations > Make Local).", name=mesh.name)
    keys = mesh.shape_keys
    if keys is not None and keys.library is not None:
        return told("The shape keys of {name} are linked from another file. Make them local first.", name=mesh.name)
    if keys is not None and not keys.use_relative:
        return told(
            "The shape keys of {name} are absolute. Tick Relative in the Shape Keys panel first.", name=mesh.name
        )
    key = form_key(mesh) if keys is not None else None
    if key is not None and key.lock_shape:
        return told("The shape key {name} is locked. Unlock it in the Shape Keys panel first.", name=key.name)
    active = bpy.context.view_layer.objects.active
    along = active is not None and obj.mode == active.mode == "EDIT"  # Blender edits several objects at once
    if obj.mode != "OBJECT" and obj != active and not along:
        return told("{name} is not the active object. Make it active, or leave its mode, and run again.", name=obj.name)
    if obj.mode != "EDIT" and mesh.is_editmode:
        return told("{name} is being edited through another object. Leave Edit Mode there first.", name=mesh.name)
    made = bool(obj.modifiers) or obj.mode != "OBJECT"  # by modifiers, or in Edit Mode, not in the mesh yet
    if not mesh.polygons and not made:
        return told("{name} has no faces. Choose a mesh with a surface.", name=mesh.name)
    return None


def read_mesh(mesh: bpy.types.Mesh) -> tuple[FloatArray, IntArray]:
    """Read the base mesh: the Basis if there are shape keys, with n-gons as triangles.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its object in Object Mode.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions in the mesh's local space.
    faces : (m, 3) ndarray of int
        Triangles.
    """
    return basis_positions(mesh).reshape(-1, 3).astype(np.float64), _triangles(mesh)


def read_object(obj: bpy.types.Object, deformed: bool = False) -> Reading:
    """Read an object as arrays for a long computation.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    deformed : bool
        Read the evaluated mesh, with modifiers, pose and shape keys at the current frame, instead of the base mesh.

    Returns
    -------
    Reading
        Its arrays.

    Raises
    ------
    CanonicalFormError
        If the evaluated mesh is requested and the object is disabled in the viewport.
    """
    vertices, faces = read_mesh(obj.data)
    known = _mesh_fingerprint(obj.data)
    if deformed:
        vertices, faces = read_shown(obj)
    frame = bpy.context.scene.frame_current if deformed else None
    placement = placement_of(obj, deformed)
    mirrors = () if deformed else mirrors_of(obj)
    return Reading(obj.name, obj.session_uid, vertices, faces, known, deformed, frame, placement, mirrors)


def read_evaluated(obj: bpy.types.Object) -> tuple[FloatArray, IntArray]:
    """Read the evaluated mesh: with modifiers, pose and shape keys at the current frame.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions in the object's local space.
    faces : (m, 3) ndarray of int
        Triangles.

    Raises
    ------
    CanonicalFormError
        If Blender does not evaluate the object because it is disabled in the viewport.
    """
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(graph)
    if evaluated.original == evaluated or obj.name not in graph.objects:
        raise CanonicalFormError(
            told(
                "{name} is switched off in the views, so nothing is shown. Switch it on, or set Mesh to Base Mesh.",
                name=obj.name,
            )
        )
    if not evaluated.data.polygons:
        raise InvalidMeshError(_without_surface(obj, graph))
    mesh = evaluated.to_mesh()
    try:
        vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
        mesh.vertices.foreach_get("co", vertices)
        return vertices.reshape(-1, 3).astype(np.float64), _triangles(mesh)
    finally:
        evaluated.to_mesh_clear()


def _without_surface(obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> str:
    """Say why an object shows no surface of its own."""
    made = [each.object.type for each in graph.object_instances if each.is_instance and each.parent.original == obj]
    if "MESH" in made:  # curves and points are listed as instances, too
        return told(
            "{name} shows instances only. Realize Instances (a geometry node) makes a mesh of them.", name=obj.name
        )
    return told(
        "{name} shows no faces: its modifiers make points or curves, or remove all faces. Curve to Mesh, a geometry "
        "node, makes a surface.",
        name=obj.name,
    )


def selected_vertices(mesh: bpy.types.Mesh) -> IntArray:
    """Return the selected vertices of a mesh.

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


def names_of(readings: Iterable[Reading]) -> frozenset[str]:
    """Return the names of the objects of readings, in no particular order.

    Parameters
    ----------
    readings : iterable of Reading
        The readings.

    Returns
    -------
    frozenset of str
        The names.
    """
    return frozenset(reading.name for reading in readings)


def find_object(reading: Reading) -> bpy.types.Object:
    """Return the object of a reading, to write its result.

    Parameters
    ----------
    reading : Reading
        The reading made before the computation.

    Returns
    -------
    bpy.types.Object
        The object.

    Raises
    ------
    CanonicalFormError
        If it was deleted or renamed, or cannot be written to.
    """
    obj = bpy.data.objects.get(reading.name)
    if obj is None or obj.session_uid != reading.session_uid or not obj.users_scene:
        raise CanonicalFormError(
            told(
                "{name} was deleted or renamed while its form was computed. Nothing was written; run again.",
                name=reading.name,
            )
        )
    reason = refusal(obj)
    if reason is not None:
        raise CanonicalFormError(told("{reason} Nothing was written.", reason=reason))
    return obj


def require_unchanged(obj: bpy.types.Object, reading: Reading) -> None:
    """Require that a mesh has not changed since it was read.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    reading : Reading
        The reading made before the computation.

    Raises
    ------
    CanonicalFormError
        If its vertices or faces have changed.
    """
    same = _mesh_fingerprint(obj.data) == reading.fingerprint
    if same and reading.deformed:
        vertices, faces = read_shown(obj)
        same = np.array_equal(vertices, reading.vertices) and np.array_equal(faces, reading.faces)
    if not same:
        raise CanonicalFormError(
            told("{name} was edited while its form was computed. Nothing was written; run again.", name=reading.name)
        )


def read_shown(obj: bpy.types.Object) -> tuple[FloatArray, IntArray]:
    """Read the evaluated mesh without an earlier form; seams of the base mesh are closed if it has more vertices.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    vertices, faces : ndarray
        As from `read_evaluated`.

    Raises
    ------
    CanonicalFormError
        As `read_evaluated`.
    """
    from .seams import closed_seams, evaluated_places, has_seams, longest_border_edge

    with muted_results([obj.data]):
        vertices, faces = read_evaluated(obj)
        if len(vertices) == len(obj.data.vertices):
            return vertices, faces
        base = read_mesh(obj.data)
        places = evaluated_places(obj) if has_seams(*base) else None
    if places is not None and len(places) == len(vertices):
        vertices = closed_seams(vertices, faces, places, longest_border_edge(*base))
    return vertices, faces


def basis_positions(mesh: bpy.types.Mesh) -> np.ndarray:
    """Read the positions of a mesh without shape keys.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (3 n,) ndarray of float32
        The positions.
    """
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    if mesh.shape_keys is None:
        mesh.attributes["position"].data.foreach_get("vector", vertices)  # all at once; `co` would be copied one by one
    else:
        mesh.shape_keys.reference_key.points.foreach_get("co", vertices)
    return vertices


def _mesh_fingerprint(mesh: bpy.types.Mesh) -> str:
    """Hash positions, and the vertex and edge of every corner, which determine the polygons; triangles take longer."""
    corners = [np.empty(len(mesh.loops), dtype=np.int32) for _ in range(2)]
    for name, values in zip((".corner_vert", ".corner_edge"), corners, strict=True) if len(mesh.loops) else ():
        mesh.attributes[name].data.foreach_get("value", values)
    return fingerprint(basis_positions(mesh), *corners)


def _triangles(mesh: bpy.types.Mesh) -> IntArray:
    mesh.calc_loop_triangles()
    faces = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    return faces.reshape(-1, 3).astype(np.int64)
