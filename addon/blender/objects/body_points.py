"""Feature points fixed by hand, with the names of their limbs: an attribute of the mesh, which belongs to the user."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError, Settings
from ...core.symmetry.limb_names import NAMES, mate_of
from ..records.record import read_record
from ..words.wording import told
from .mesh_reading import Reading, read_mesh, refusal
from .movers import armature_of
from .object_states import object_mode
from .seams import evaluated_places, vertex_places

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray

ATTRIBUTE = ".canonical_form_points"  # of vertices: 0 for none, or a code
_CODES = dict(zip((*NAMES, ""), (100003, 200017, 400067, 800029, 1600033, 3200003, 6400013), strict=True))
_NAMED = {code: name for name, code in _CODES.items()}  # what Blender blends between vertices is none of these
_MOST_EDITED = 60_000  # vertices in Edit Mode up to which the points are read, as they must be one by one
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
        if len(edited.verts) > _MOST_EDITED:
            return NO_POINTS
        layer = edited.verts.layers.int.get(ATTRIBUTE)
        codes = np.array([] if layer is None else [vertex[layer] for vertex in edited.verts], dtype=np.int32)
    else:
        codes = np.zeros(len(mesh.vertices), dtype=np.int32)
        attribute = mesh.attributes[ATTRIBUTE]
        if attribute.data_type == "INT" and len(attribute.data) == len(codes):
            attribute.data.foreach_get("value", codes)
    held = np.flatnonzero(np.isin(codes, list(_NAMED)))
    points = BodyPoints([], [])
    for vertex in held[np.argsort(codes[held], kind="stable")].tolist():
        name = _NAMED[int(codes[vertex])]
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
        codes[points.vertices] = [_CODES[name] for name in points.names]
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
    first = {obj.data: obj for obj in reversed(objects)}  # of objects that share a mesh, the first has its points
    fixed = [points_by_hand(obj.data) if first[obj.data] == obj else NO_POINTS for obj in objects]
    if any(each.vertices for each in fixed):
        return fixed, True
    return [_of_last_run(obj) if first[obj.data] == obj else NO_POINTS for obj in objects], False


def _of_last_run(obj: bpy.types.Object) -> BodyPoints:
    """Return the points that the last run found on an object."""
    record = read_record(obj.data)
    if record is None or record.report.vertices != len(obj.data.vertices):  # edited since
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

    def change(points: list[BodyPoints], number: int) -> None:
        points[:] = [_kept(each, lambda _, own: not name or own != name) for each in points]
        places = read_mesh(obj.data)[0]
        near = _REPLACED * float(np.ptp(places, axis=0).max())
        away = np.linalg.norm(places - places[vertex], axis=1)
        left = _kept(points[number], lambda own, called: own != vertex and bool(called or away[own] > near))
        points[number] = BodyPoints([*left.vertices, vertex], [*left.names, name])

    _change(objects, obj, change)


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

    def change(points: list[BodyPoints], number: int) -> None:
        points[number] = _kept(points[number], lambda own, _: own != vertex)

    _change(objects, obj, change)


def swap_sides(objects: Sequence[bpy.types.Object]) -> None:
    """Call what is left right. The points are fixed by hand from now on.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body, in any mode.
    """

    def change(points: list[BodyPoints], _: int) -> None:
        points[:] = [each._replace(names=[mate_of(name) for name in each.names]) for each in points]

    _change(objects, objects[0], change)


def forget_points(objects: Sequence[bpy.types.Object]) -> None:
    """Take all points fixed by hand off a body, so that the next run finds them by itself.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of the body, in any mode.
    """

    def change(points: list[BodyPoints], _: int) -> None:
        points[:] = [NO_POINTS] * len(points)

    _change(objects, objects[0], change)


def _change(
    objects: Sequence[bpy.types.Object], obj: bpy.types.Object, change: Callable[[list[BodyPoints], int], None]
) -> None:
    """Change the points of the objects that are one body with `obj`, once for each mesh, in Object Mode."""
    own = list({each.data: each for each in (obj, *_one_body(obj, objects))}.values())
    with ExitStack() as modes:
        for each in own:
            modes.enter_context(object_mode(each))
        points, _ = body_points(own)
        number = next(index for index, each in enumerate(own) if each.data == obj.data)
        change(points, number)
        for each, found in zip(own, points, strict=True):
            write_points(each.data, found)


def _one_body(obj: bpy.types.Object, objects: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """List the objects that are one body with another: moved by the same armature, or else within each other's box."""
    rig = armature_of(obj)
    others = [each for each in objects if each != obj and refusal(each) is None]
    if rig is not None:
        return [each for each in others if armature_of(each) == rig]
    body, boxes = [obj], {each: _box(each) for each in (obj, *others)}
    for each in body:
        body += [other for other in others if other not in body and _meet(boxes[each], boxes[other])]
    return body[1:]


def _box(obj: bpy.types.Object) -> FloatArray:
    """Return the lowest and the highest corner of an object in the scene, (2, 3)."""
    place = np.array(obj.matrix_world)
    corners = np.array(obj.bound_box) @ place[:3, :3].T + place[:3, 3]
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def _meet(one: FloatArray, other: FloatArray) -> bool:
    """Return whether two boxes (2, 3) overlap, or nearly do."""
    slack = _REPLACED * float(np.ptp(one, axis=0).max())
    return bool((one[0] - slack <= other[1]).all() and (other[0] - slack <= one[1]).all())


def _kept(points: BodyPoints, keep: Callable[[int, str], bool]) -> BodyPoints:
    """Keep some of the points."""
    kept = [pair for pair in zip(*points, strict=True) if keep(*pair)]
    return BodyPoints([vertex for vertex, _ in kept], [name for _, name in kept])


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
    base = vertex_places(obj.data)
    size = float(np.ptp(reading.vertices, axis=0).max())
    found = BodyPoints([], [])
    images = BodyPoints([], [])
    for vertex, name in zip(*points, strict=True):
        away = np.linalg.norm(places - base[vertex], axis=1)
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
    names = [name for each in points for name in each.names]
    once = [name if name not in names[:number] else "" for number, name in enumerate(names)]  # a shirt has its own
    return replace(settings, feature_points=vertices, feature_names=once)
