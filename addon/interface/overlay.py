"""Feature points as labelled dots in the 3D View."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin
from typing import Any, ClassVar

import bpy

from ..blender.jobs.meant_objects import meant_object
from ..blender.records.form_key import form_key
from ..blender.records.record import Record, read_record
from ..blender.results.companions import companions_of

_DOT = 5.0  # radius in pixels
_TEXT = 13.0
_CIRCLE = [(cos(2 * pi * turn / 16), sin(2 * pi * turn / 16)) for turn in range(16)]


class VIEW3D_GGT_canonical_form:
    """Holds the handle of the draw callback while the extension is registered; never instantiated."""

    handle: ClassVar[Any] = None


def feature_labels(obj: bpy.types.Object | None, graph: bpy.types.Depsgraph) -> list[tuple[Any, tuple, str]]:
    """Return the labels for the feature points of an object and its companions, placed on the evaluated meshes.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.
    graph : bpy.types.Depsgraph
        The evaluated dependency graph.

    Returns
    -------
    list of (mathutils.Vector, tuple of float, str)
        World position, sRGB colour and label of each.
    """
    if obj is None or obj.type != "MESH":
        return []
    return [label for each in companions_of(obj) for label in _labels_on(each, graph)]


def _labels_on(obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> list[tuple[Any, tuple, str]]:
    """Return the labels for the feature points on one object."""
    record = read_record(obj.data)
    if record is None or not obj.visible_get():
        return []
    points = record.report.feature_points
    places = _places(obj, graph, record)
    palette = record.palette or [[1.0, 1.0, 1.0]] * len(points)
    return [
        (obj.matrix_world @ places[point], (*_srgb(colour), 1.0), str(number))
        for number, (point, colour) in enumerate(zip(points, palette, strict=True), start=1)
        if point in places
    ]


def _places(obj: bpy.types.Object, graph: bpy.types.Depsgraph, record: Record) -> dict[int, Any]:
    """Return the positions at which the object shows its feature points."""
    wanted = [point for point in record.report.feature_points if 0 <= point < record.report.vertices]
    if obj.mode == "EDIT":
        import bmesh

        edited = bmesh.from_edit_mesh(obj.data).verts
        edited.ensure_lookup_table()
        return {point: edited[point].co for point in wanted if point < len(edited)}
    shown = obj.evaluated_get(graph).data.vertices
    key = form_key(obj.data)
    if len(shown) == record.report.vertices:
        return {point: shown[point].co for point in wanted}
    if key is None or key.mute:  # modifiers change the number of vertices
        return {point: obj.data.vertices[point].co for point in wanted if point < len(obj.data.vertices)}
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
    if not context.scene.canonical_form.show_points or not space.overlay.show_overlays:
        return
    scale = context.preferences.system.ui_scale
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    for place, colour, label in feature_labels(meant_object(context), context.evaluated_depsgraph_get()):
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
