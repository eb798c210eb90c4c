"""Feature points fixed by hand, with the names of their limbs: an attribute of the mesh, which belongs to the user."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError, Settings
from ...core.symmetry.limb_names import NAMES, mate_of
from ..records.record import read_record
from ..words.wording import told
from .mesh_reading import Reading, read_mesh
from .object_states import object_mode
from .seams import evaluated_places

ATTRIBUTE = ".canonical_form_points"  # of vertices: 0 for none, the number of a name from 1, or `_OTHER`
_OTHER = 100  # a limb without a name
_NEAR = 1e-5  # of the size of the mesh: places within that are one
_REPLACED = 0.06  # of the size of the mesh: a point without a name that is nearer to a new one was the same limb


class BodyPoints(NamedTuple):
    """Feature points on an object.

    Attributes
    ----------
    vertices : list of int
        Vertices.
    names : list of str
        Names of the limbs as in `Settings`, "" for none.
    """

    vertices: list[int]
    names: list[str]


NO_POINTS = BodyPoints([], [])


def points_by_hand(mesh: bpy.types.Mesh) -> BodyPoints:
    """Read the points that were fixed by hand on a mesh, in any mode.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    BodyPoints
        In the order of the names; the first of several vertices with one name, which edits may make.
    """
    if ATTRIBUTE not in mesh.attributes:
        return NO_POINTS
    if mesh.is_editmode:
        import bmesh

        edited = bmesh.from_edit_mesh(mesh)
        layer = edited.verts.layers.int.get(ATTRIBUTE)
        codes = np.array([] if layer is None else [vertex[layer] for vertex in edited.verts], dtype=np.int32)
    else:
        codes = np.zeros(len(mesh.vertices), dtype=np.int32)
        attribute = mesh.attributes[ATTRIBUTE]
        if attribute.data_type == "INT" and len(attribute.data) == len(codes):
            attribute.data.foreach_get("value", codes)
    held = np.flatnonzero(codes)
    held = held[np.argsort(codes[held], kind="stable")].tolist()
    points = BodyPoints([], [])
    for vertex in held:
        name = NAMES[codes[vertex] - 1] if 1 <= codes[vertex] <= len(NAMES) else ""
        if not name or name not in points.names:
            points.vertices.append(vertex)
            points.names.append(name)
    return points


def write_points(mesh: bpy.types.Mesh, points: BodyPoints) -> None:
    """Replace the points that were fixed by hand on a mesh; without any, nothing is left of them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.
    points : BodyPoints
        The points.
    """
    if ATTRIBUTE in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[ATTRIBUTE])
    if points.vertices:
        codes = np.zeros(len(mesh.vertices), dtype=np.int32)
        codes[points.vertices] = [NAMES.index(name) + 1 if name else _OTHER for name in points.names]
        mesh.attributes.new(ATTRIBUTE, "INT", "POINT").data.foreach_set("value", codes)
    mesh.update()


def body_points(objects: Sequence[bpy.types.Object]) -> tuple[list[BodyPoints], bool]:
    """Return the points of a body: those fixed by hand, else those of the last run.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body.

    Returns
    -------
    points : list of BodyPoints
        Of each object.
    by_hand : bool
        Whether they were fixed by hand.
    """
    fixed = [points_by_hand(obj.data) for obj in objects]
    if any(each.vertices for each in fixed):
        return fixed, True
    return [_of_last_run(obj) for obj in objects], False


def _of_last_run(obj: bpy.types.Object) -> BodyPoints:
    """Return the points that the last run found on an object."""
    record = read_record(obj.data)
    if record is None or obj.data.is_editmode:
        return NO_POINTS
    report = record.report
    names = report.feature_names or [""] * len(report.feature_points)
    last = len(obj.data.vertices)
    held = [pair for pair in zip(report.feature_points, names, strict=True) if 0 <= pair[0] < last]
    return BodyPoints([vertex for vertex, _ in held], [name for _, name in held])


def fix_point(objects: Sequence[bpy.types.Object], obj: bpy.types.Object, vertex: int, name: str) -> None:
    """Put the point of a limb on a vertex; the others stay where they are, and are fixed by hand from now on.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body, in any mode.
    obj : bpy.types.Object
        The one among them that the vertex is of.
    vertex : int
        The vertex.
    name : str
        Name of the limb; "" for one without a name.
    """
    points = [_without(each, name) for each in body_points(objects)[0]]
    number = list(objects).index(obj)
    points[number] = _without_near(obj, points[number], vertex)
    points[number] = BodyPoints([*points[number].vertices, vertex], [*points[number].names, name])
    _write_all(objects, points)


def remove_point(objects: Sequence[bpy.types.Object], obj: bpy.types.Object, vertex: int) -> None:
    """Take a point off a body: it is no limb. The others are fixed by hand from now on.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body, in any mode.
    obj : bpy.types.Object
        The one among them that has the point.
    vertex : int
        Its vertex.
    """
    points = body_points(objects)[0]
    number = list(objects).index(obj)
    kept = [pair for pair in zip(*points[number], strict=True) if pair[0] != vertex]
    points[number] = BodyPoints([own for own, _ in kept], [name for _, name in kept])
    _write_all(objects, points)


def swap_sides(objects: Sequence[bpy.types.Object]) -> None:
    """Call what is left right. The points are fixed by hand from now on.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body, in any mode.
    """
    points = body_points(objects)[0]
    _write_all(objects, [each._replace(names=[mate_of(name) for name in each.names]) for each in points])


def forget_points(objects: Sequence[bpy.types.Object]) -> None:
    """Take all points fixed by hand off a body, so that the next run finds them by itself.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body, in any mode.
    """
    _write_all(objects, [NO_POINTS] * len(objects))


def _write_all(objects: Sequence[bpy.types.Object], points: Sequence[BodyPoints]) -> None:
    for obj, own in zip(objects, points, strict=True):
        with object_mode(obj):
            write_points(obj.data, own)


def _without(points: BodyPoints, name: str) -> BodyPoints:
    """Leave out the point of a name."""
    kept = [pair for pair in zip(*points, strict=True) if not name or pair[1] != name]
    return BodyPoints([vertex for vertex, _ in kept], [own for _, own in kept])


def _without_near(obj: bpy.types.Object, points: BodyPoints, vertex: int) -> BodyPoints:
    """Leave out points without a name near a vertex, and whatever is on it."""
    with object_mode(obj):
        places = read_mesh(obj.data)[0]
    near = _REPLACED * float(np.ptp(places, axis=0).max())
    kept = [
        (own, name)
        for own, name in zip(*points, strict=True)
        if own != vertex and (name or np.linalg.norm(places[own] - places[vertex]) > near)
    ]
    return BodyPoints([own for own, _ in kept], [name for _, name in kept])


def points_on(obj: bpy.types.Object, reading: Reading, points: BodyPoints) -> BodyPoints:
    """Find points of a mesh on what is computed: modifiers may have changed the number of vertices.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    reading : Reading
        Its arrays.
    points : BodyPoints
        Points of its mesh.

    Returns
    -------
    BodyPoints
        The same on the vertices of the reading; mirror images that modifiers make of them have the name of the other
        side.

    Raises
    ------
    CanonicalFormError
        If the modifiers keep no trace of the vertices.
    """
    if not points.vertices or len(reading.vertices) == len(obj.data.vertices):
        return points
    places = evaluated_places(obj)
    if places is None or len(places) != len(reading.vertices):
        raise CanonicalFormError(
            told("The modifiers of {name} keep no trace of its feature points. Set Mesh to Base Mesh.", name=obj.name)
        )
    base = np.empty(3 * len(obj.data.vertices), dtype=np.float32)
    obj.data.vertices.foreach_get("co", base)
    size = float(np.ptp(reading.vertices, axis=0).max())
    found = BodyPoints([], [])
    images = BodyPoints([], [])
    for vertex, name in zip(*points, strict=True):
        away = np.linalg.norm(places - base.reshape(-1, 3)[vertex], axis=1)
        own = int(away.argmin())
        found.vertices.append(own)
        found.names.append(name)
        alike = np.flatnonzero(away <= away[own] + _NEAR * size)
        apart = np.linalg.norm(reading.vertices[alike] - reading.vertices[own], axis=1) > _REPLACED * size
        mate = mate_of(name)
        if apart.any() and (not name or mate != name):  # a head has no image
            images.vertices.append(int(alike[apart][0]))
            images.names.append(mate if mate not in points.names else "")
    return BodyPoints([*found.vertices, *images.vertices], [*found.names, *images.names])


def with_points(settings: Settings, points: Sequence[BodyPoints], starts: Sequence[int]) -> Settings:
    """Add the points of objects to settings, by their numbers on a mesh of all objects, one after the other.

    Parameters
    ----------
    settings : Settings
        The options; points that they have come first, and are of the first object.
    points : sequence of BodyPoints
        Points on each object, at least one.
    starts : sequence of int
        Where the vertices of each begin, and maybe where those of the last end.

    Returns
    -------
    Settings
        The options with all points; unchanged if there are none.

    Examples
    --------
    >>> with_points(Settings(), [BodyPoints([2], ["head"]), BodyPoints([0], [""])], [0, 10, 20]).feature_points
    [2, 10]
    """
    if settings.feature_points is not None or not any(each.vertices for each in points):
        return settings
    vertices = [start + own for start, each in zip(starts, points, strict=False) for own in each.vertices]
    return replace(settings, feature_points=vertices, feature_names=[name for each in points for name in each.names])
