"""The ends of the limbs as labelled dots in the 3D View."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin
from typing import Any, ClassVar

import bpy

from ..blender.jobs.meant_objects import meant_meshes
from ..blender.objects.body_points import BodyPoints, body_points
from ..blender.records.form_key import form_key
from ..blender.records.record import read_record
from ..blender.words.limb_words import told_limb
from .choices import choices_of

_DOT = 5.0  # radius in pixels
_TEXT = 13.0
_PLAIN, _BY_HAND = (1.0, 1.0, 1.0), (1.0, 0.35, 0.0)  # linear colours of dots without a patch
_CIRCLE = [(cos(2 * pi * turn / 16), sin(2 * pi * turn / 16)) for turn in range(16)]


class VIEW3D_GGT_canonical_form:
    """Holds the handle of the draw callback while the extension is registered; never instantiated."""

    handle: ClassVar[Any] = None


def feature_labels(
    objects: Sequence[bpy.types.Object], graph: bpy.types.Depsgraph
) -> list[tuple[Any, tuple[float, ...], str]]:
    """Return the labels for the feature points of a body, placed on the evaluated meshes.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Its mesh objects.
    graph : bpy.types.Depsgraph
        The evaluated dependency graph.

    Returns
    -------
    list of (mathutils.Vector, tuple of float, str)
        World position, sRGB colour and label of each.
    """
    points, by_hand = body_points(objects)
    return [
        label
        for obj, own in zip(objects, points, strict=True)
        if obj.visible_get()
        for label in _labels_on(obj, graph, own, by_hand)
    ]


def _labels_on(
    obj: bpy.types.Object, graph: bpy.types.Depsgraph, points: BodyPoints, by_hand: bool
) -> list[tuple[Any, tuple[float, ...], str]]:
    """Return the labels for the feature points on one object, in the colours of their patches if there are some."""
    record = read_record(obj.data)
    numbers = [] if record is None else record.report.feature_points
    palette = [] if record is None else record.palette
    places = _places(obj, graph, points.vertices)
    labels = []
    for vertex, name in zip(*points, strict=True):
        number = numbers.index(vertex) if vertex in numbers else -1
        colour = palette[number] if 0 <= number < len(palette) else _BY_HAND if by_hand else _PLAIN
        text = told_limb(name) if name or number < 0 else str(number + 1)
        if vertex in places:
            labels.append((obj.matrix_world @ places[vertex], (*_srgb(colour), 1.0), text))
    return labels


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
    import blf
    import gpu
    from bpy_extras.view3d_utils import location_3d_to_region_2d
    from gpu_extras.batch import batch_for_shader

    context = bpy.context
    space = context.space_data
    choices, meshes = choices_of(context), meant_meshes(context)
    if choices is None or not choices.show_points or not space.overlay.show_overlays:
        return
    scale = context.preferences.system.ui_scale
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    for place, colour, label in feature_labels(meshes, context.evaluated_depsgraph_get()):
        at = location_3d_to_region_2d(context.region, context.region_data, place)
        if at is None:
            continue
        for radius, shade in ((_DOT + 2, (0.0, 0.0, 0.0, 1.0)), (_DOT, colour)):
            shader.uniform_float("color", shade)
            circle = [(at.x + radius * scale * x, at.y + radius * scale * y) for x, y in _CIRCLE]
            batch_for_shader(shader, "TRI_FAN", {"pos": circle}).draw(shader)
        blf.size(0, _TEXT * scale)
        blf.enable(0, blf.SHADOW)
        blf.shadow(0, 5, 0.0, 0.0, 0.0, 0.9)
        blf.color(0, 1.0, 1.0, 1.0, 1.0)
        blf.position(0, at.x + 1.8 * _DOT * scale, at.y + 0.5 * _DOT * scale, 0.0)
        blf.draw(0, label)
        blf.disable(0, blf.SHADOW)


def register() -> None:
    """Add the draw callback, if there is a window."""
    if not bpy.app.background:
        VIEW3D_GGT_canonical_form.handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    """Remove the draw callback."""
    if VIEW3D_GGT_canonical_form.handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(VIEW3D_GGT_canonical_form.handle, "WINDOW")
        VIEW3D_GGT_canonical_form.handle = None
