"""The ends of the limbs as labelled dots in the 3D View, and what is doubtful with a legend."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin
from typing import Any, ClassVar, NamedTuple

import bpy
from mathutils import Vector

from ..blender.jobs.meant_objects import meant_meshes
from ..blender.objects.body_points import BodyPoints, body_points
from ..blender.records.form_key import form_key
from ..blender.records.hidden_attributes import contacts_of
from ..blender.records.record import read_record
from ..blender.records.rig_record import DOUBTFUL, read_rig
from ..blender.words.limb_words import told_limb
from ..blender.words.wording import listed, told
from .choices import choices_of

_DOT = 5.0  # radius in pixels
_SMALL = 2.0  # of the dots of contacts
_TEXT = 13.0
_LEGEND = (70.0, 135.0)  # where the legend begins: from the left, and below the name of the view
_MOST_CONTACTS = 300  # that are drawn
_PARTED, _UNSURE = (1.0, 0.85, 0.1, 1.0), (0.86, 0.19, 0.19, 1.0)  # the latter as Blender draws their bones
_PLAIN, _BY_HAND = (1.0, 1.0, 1.0), (1.0, 0.35, 0.0)  # linear colours of dots without a patch
_CIRCLE = [(cos(2 * pi * turn / 16), sin(2 * pi * turn / 16)) for turn in range(16)]


class OverlayHandle:
    """Holds the handle of the draw callback while the extension is registered; never instantiated."""

    handle: ClassVar[Any] = None


class ShownPoint(NamedTuple):
    """The end of a limb as the view shows it.

    Attributes
    ----------
    obj : bpy.types.Object
        The object that has it.
    vertex : int
        Its vertex.
    name : str
        The limb, as the core names it; "" for one without a name.
    place : mathutils.Vector
        Where it is in the world.
    colour : tuple of float
        Its sRGB colour with alpha.
    label : str
        What is written beside it.
    """

    obj: bpy.types.Object
    vertex: int
    name: str
    place: Any
    colour: tuple[float, ...]
    label: str


def shown_points(objects: Sequence[bpy.types.Object], graph: bpy.types.Depsgraph) -> list[ShownPoint]:
    """Return the feature points of a body, placed on the evaluated meshes.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Its mesh objects.
    graph : bpy.types.Depsgraph
        The evaluated dependency graph.

    Returns
    -------
    list of ShownPoint
        Those on objects that are visible.
    """
    points, by_hand = body_points(objects)
    return [
        shown
        for obj, own in zip(objects, points, strict=True)
        if obj.visible_get()
        for shown in _shown_on(obj, graph, own, by_hand)
    ]


def _shown_on(obj: bpy.types.Object, graph: bpy.types.Depsgraph, points: BodyPoints, by_hand: bool) -> list[ShownPoint]:
    """Return the feature points on one object, in the colours of their patches if there are some."""
    record = read_record(obj.data)
    numbers = [] if record is None else record.report.feature_points
    palette = [] if record is None else record.palette
    places = _places(obj, graph, points.vertices)
    shown = []
    for vertex, name in zip(*points, strict=True):
        number = numbers.index(vertex) if vertex in numbers else -1
        colour = palette[number] if 0 <= number < len(palette) else _BY_HAND if by_hand else _PLAIN
        text = told_limb(name) if name or number < 0 else str(number + 1)
        if vertex in places:
            place = obj.matrix_world @ places[vertex]
            shown.append(ShownPoint(obj, vertex, name, place, (*_srgb(colour), 1.0), text))
    return shown


def _places(obj: bpy.types.Object, graph: bpy.types.Depsgraph, wanted: Sequence[int]) -> dict[int, Any]:
    """Return the positions at which the object shows some of its vertices."""
    if obj.mode == "EDIT":
        import bmesh

        edited = bmesh.from_edit_mesh(obj.data).verts
        edited.ensure_lookup_table()
        return {point: edited[point].co for point in wanted if point < len(edited)}
    shown = obj.evaluated_get(graph).data.vertices
    key = form_key(obj.data)
    if len(shown) == len(obj.data.vertices):
        return {point: shown[point].co for point in wanted}
    if key is None or key.mute:  # modifiers change the number of vertices
        return {point: obj.data.vertices[point].co for point in wanted}
    rest = key.relative_key.data
    return {point: rest[point].co.lerp(key.data[point].co, key.value) for point in wanted if point < len(rest)}


def _srgb(colour: Sequence[float]) -> tuple[float, ...]:
    """Convert linear RGB to sRGB."""
    return tuple(1.055 * max(part, 0.0031308) ** (1 / 2.4) - 0.055 for part in colour)


def _draw() -> None:
    """Draw the dots with their labels, and what is doubtful with its legend."""
    import gpu
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    context = bpy.context
    choices, meshes = choices_of(context), meant_meshes(context)
    if choices is None or not choices.show_points or not context.space_data.overlay.show_overlays:
        return
    graph, scale = context.evaluated_depsgraph_get(), context.preferences.system.ui_scale
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    contacts = [each for obj in meshes if obj.visible_get() for each in _contacts_on(obj, graph)]
    for place in contacts:
        at = location_3d_to_region_2d(context.region, context.region_data, place)
        if at is not None:
            _disc(shader, at, _SMALL * scale, _PARTED)
    covered = _covered_width(context)
    written: list[tuple[float, float, float]] = []  # x, y and width of each label
    for point in shown_points(meshes, graph):
        at = location_3d_to_region_2d(context.region, context.region_data, point.place)
        if at is None:
            continue
        _disc(shader, at, (_DOT + 2) * scale, (0.0, 0.0, 0.0, 1.0))
        _disc(shader, at, _DOT * scale, point.colour)
        width = _text_size(point.label, scale)
        beside = 1.8 * _DOT * scale
        room = at.x + beside + width <= context.region.width - covered
        x, y = at.x + (beside if room else -beside - width), at.y + 0.5 * _DOT * scale
        while any(left < x + width and x < left + wide and abs(y - low) < _TEXT * scale for left, low, wide in written):
            y += _TEXT * scale  # above the one that it would hide
        written.append((x, y, width))
        _write(point.label, x, y, scale)
    _draw_legend(shader, meshes, bool(contacts), scale)


def _draw_legend(shader: Any, meshes: Sequence[bpy.types.Object], parted: bool, scale: float) -> None:
    """Say what the colours of contacts and of doubtful bones mean, below the name of the view."""
    rig = next((record for record in (read_rig(obj.data) for obj in meshes) if record is not None), None)
    doubtful = [] if rig is None else [bone for bone, sure in rig.confidence.items() if sure < DOUBTFUL]
    lines = [(_PARTED, told("Skin that was parted"))] if parted else []
    if doubtful:
        lines.append((_UNSURE, told("Bones that hardly fit: {bones}", bones=listed(doubtful))))
    region = bpy.context.region
    for number, (colour, text) in enumerate(lines):
        at = Vector((_LEGEND[0] * scale, region.height - (_LEGEND[1] + 1.6 * _TEXT * number) * scale))
        _disc(shader, at, _DOT * scale, colour)
        _write(text, at.x + 2 * _DOT * scale, at.y - 0.8 * _DOT * scale, scale)


def _contacts_on(obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> list[Any]:
    """Return where an object shows the vertices at which its skin was parted; of many, some."""
    if obj.mode == "EDIT" or read_record(obj.data) is None:
        return []
    vertices = contacts_of(obj.data)
    some = vertices[:: 1 + len(vertices) // _MOST_CONTACTS].tolist()
    return [obj.matrix_world @ place for place in _places(obj, graph, some).values()] if some else []


def _covered_width(context: bpy.types.Context) -> int:
    """Return how much of the view the sidebar covers at its right, in pixels."""
    sidebars = [each for each in context.area.regions if each.type == "UI" and each.alignment == "RIGHT"]
    covered = [each.width for each in sidebars if each.width > 1 and each.x < context.region.x + context.region.width]
    return max(covered, default=0)


def _disc(shader: Any, at: Any, radius: float, colour: tuple[float, ...]) -> None:
    """Draw a disc in the region."""
    from gpu_extras.batch import batch_for_shader

    shader.uniform_float("color", colour)
    circle = [(at.x + radius * x, at.y + radius * y) for x, y in _CIRCLE]
    batch_for_shader(shader, "TRI_FAN", {"pos": circle}).draw(shader)


def _text_size(text: str, scale: float) -> float:
    """Return the width of a text in pixels."""
    import blf

    blf.size(0, _TEXT * scale)
    return float(blf.dimensions(0, text)[0])


def _write(text: str, x: float, y: float, scale: float) -> None:
    """Write a text with a shadow."""
    import blf

    blf.size(0, _TEXT * scale)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 5, 0.0, 0.0, 0.0, 0.9)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.position(0, x, y, 0.0)
    blf.draw(0, text)
    blf.disable(0, blf.SHADOW)


def register() -> None:
    """Add the draw callback, if there is a window."""
    if not bpy.app.background:
        OverlayHandle.handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    """Remove the draw callback."""
    if OverlayHandle.handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(OverlayHandle.handle, "WINDOW")
        OverlayHandle.handle = None
