"""Feature points as labelled dots over the 3D View."""

from __future__ import annotations

from typing import Any, ClassVar

import bpy

from ..blender.records import record_of

_DOT = 9.0  # pixels
_TEXT = 13.0


class VIEW3D_GGT_canonical_form:
    """Holds the drawing while the extension is registered; never an instance."""

    handle: ClassVar[Any] = None


def feature_labels(obj: bpy.types.Object | None, graph: bpy.types.Depsgraph) -> list[tuple[Any, tuple, str]]:
    """List the feature points of an object where they are seen now.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.
    graph : bpy.types.Depsgraph
        The evaluated scene.

    Returns
    -------
    list of (mathutils.Vector, tuple of float, str)
        Place in the world, colour and label of each.
    """
    if obj is None or obj.type != "MESH" or not obj.visible_get():
        return []
    record = record_of(obj.data)
    if record is None:
        return []
    shown = obj.evaluated_get(graph).data
    if len(shown.vertices) != record["report"]["vertices"]:  # modifiers have changed the vertices
        shown = obj.data
    palette = record["palette"] or [(1.0, 1.0, 1.0)] * len(record["report"]["feature_points"])
    return [
        (obj.matrix_world @ shown.vertices[point].co, (*colour, 1.0), str(number))
        for number, (point, colour) in enumerate(zip(record["report"]["feature_points"], palette, strict=True), start=1)
        if point < len(shown.vertices)
    ]


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
    for place, colour, label in feature_labels(context.object, context.evaluated_depsgraph_get()):
        at = location_3d_to_region_2d(context.region, context.region_data, place)
        if at is None:
            continue
        for size, shade in ((_DOT + 4, (0.0, 0.0, 0.0, 1.0)), (_DOT, colour)):
            gpu.state.point_size_set(size * scale)
            shader.uniform_float("color", shade)
            batch_for_shader(shader, "POINTS", {"pos": [at.to_3d()]}).draw(shader)
        blf.size(0, _TEXT * scale)
        blf.enable(0, blf.SHADOW)
        blf.shadow(0, 5, 0.0, 0.0, 0.0, 0.9)
        blf.color(0, 1.0, 1.0, 1.0, 1.0)
        blf.position(0, at.x + _DOT * scale, at.y + 0.3 * _DOT * scale, 0.0)
        blf.draw(0, label)
        blf.disable(0, blf.SHADOW)
    gpu.state.point_size_set(1.0)


def register() -> None:
    """Start drawing, where there is a window."""
    if not bpy.app.background:
        VIEW3D_GGT_canonical_form.handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    """Stop drawing."""
    if VIEW3D_GGT_canonical_form.handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(VIEW3D_GGT_canonical_form.handle, "WINDOW")
        VIEW3D_GGT_canonical_form.handle = None
