"""Vertices under the mouse, on what is shown, and their mirror images on the mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Vector

from .combining import moved
from .mesh_reading import read_mesh
from .object_states import object_mode
from .seams import evaluated_places, vertex_places

_MOST_HITS = 60  # surfaces in front of the body, which the ray goes through
_BEYOND = 1e-5  # of the distance, by which a ray goes on behind what it has hit
_MIRRORED = 0.04  # of the size: farther from the mirror image there is no vertex of the other side


class Picked(NamedTuple):
    """A vertex of a mesh.

    Attributes
    ----------
    obj : bpy.types.Object
        The object.
    vertex : int
        Its vertex.
    image : bool
        Whether a mirror image of it was meant, which a modifier makes.
    """

    obj: bpy.types.Object
    vertex: int
    image: bool = False


def picked(
    context: bpy.types.Context, objects: Sequence[bpy.types.Object], origin: Vector, direction: Vector
) -> Picked | None:
    """Find the vertex nearest to where a ray meets objects as they are shown; it goes through all others.

    Parameters
    ----------
    context : bpy.types.Context
        Whose scene is shown.
    objects : sequence of bpy.types.Object
        The objects of a body.
    origin, direction : mathutils.Vector
        The ray, in world space.

    Returns
    -------
    Picked or None
        The vertex of the mesh, also where modifiers make a finer one; None if it meets none of them.
    """
    graph = context.evaluated_depsgraph_get()
    for _ in range(_MOST_HITS):
        hit, place, _, face, obj, _ = context.scene.ray_cast(graph, origin, direction)
        if not hit:
            return None
        if obj.original in objects:
            return _nearest(obj.original, graph, place, face)
        origin = place + direction * max((place - origin).length, 1.0) * _BEYOND
    return None


def _nearest(obj: bpy.types.Object, graph: bpy.types.Depsgraph, place: Vector, face: int) -> Picked | None:
    """Find the vertex of a mesh at a place of a face of the evaluated one."""
    shown = obj.evaluated_get(graph)
    local = shown.matrix_world.inverted() @ place
    mesh = shown.data
    if face >= len(mesh.polygons):
        return None
    corners = list(mesh.polygons[face].vertices)
    vertex = min(corners, key=lambda corner: (mesh.vertices[corner].co - local).length)
    if len(mesh.vertices) == len(obj.data.vertices):
        return Picked(obj, int(vertex))
    shown_at = vertex_places(mesh)
    places = evaluated_places(obj)
    if places is None or len(places) != len(shown_at):
        return None
    found = int(np.linalg.norm(vertex_places(obj.data) - places[vertex], axis=1).argmin())
    first = int(np.linalg.norm(places - places[vertex], axis=1).argmin())  # images come after what they are of
    size = float(np.ptp(shown_at, axis=0).max())
    return Picked(obj, found, bool(np.linalg.norm(shown_at[first] - shown_at[vertex]) > _MIRRORED * size))


def mirrored_vertex(objects: Sequence[bpy.types.Object], there: Picked) -> Picked | None:
    """Find the vertex that is the mirror image of another on the base meshes, in X of the first object.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of a body.
    there : Picked
        A vertex of one of them.

    Returns
    -------
    Picked or None
        The vertex; None if the body is not symmetric there.
    """
    own = np.array(objects[0].matrix_world.inverted())
    placed = []
    for obj in objects:
        with object_mode(obj):
            points = read_mesh(obj.data)[0]
        placed.append(moved(points, own @ np.array(obj.matrix_world)))
    image = placed[list(objects).index(there.obj)][there.vertex] * [-1.0, 1, 1]
    size = float(np.ptp(np.concatenate(placed), axis=0).max())
    away = [np.linalg.norm(points - image, axis=1) if len(points) else np.array([np.inf]) for points in placed]
    number = int(np.argmin([each.min() for each in away]))
    found = Picked(objects[number], int(away[number].argmin()))
    return found if away[number].min() <= _MIRRORED * size and found != there else None
