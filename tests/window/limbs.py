"""The limbs of the body in the window: found, one of them fixed by a click on the body, both sides swapped, undone."""

import importlib

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

BODY_POINTS = "bl_ext.user_default.canonical_form.addon.blender.objects.body_points"


def limbs(hand, figure, state, running, wait_for_the_end):
    """Click through the box Body; the mesh is as before at the end."""
    points_by_hand = importlib.import_module(BODY_POINTS).points_by_hand
    obj = figure()
    before = state(obj)
    yield from hand.press_wish("limbs", running)
    yield from wait_for_the_end()
    yield from hand.picture("10-limbs-found")
    assert not points_by_hand(obj.data).vertices

    yield from hand.press("canonical_form_fix_point(", "limb='head'")
    yield 0.5
    yield from hand.picture("10-limbs-picking", at_once=True)
    yield from hand.over_view()
    yield from hand.key("ESC")
    assert not points_by_hand(obj.data).vertices, "Esc sets a point"

    yield from hand.press("canonical_form_fix_point(", "limb='head'")
    yield 0.3
    vertex = in_front(hand, obj)
    region = hand.region("WINDOW")
    at = location_3d_to_region_2d(region, hand.area().spaces.active.region_3d, obj.matrix_world @ place(obj, vertex))
    yield from hand.click(region.x + at.x, region.y + at.y)
    yield 0.7
    found = points_by_hand(obj.data)
    assert "head" in found.names, "the click sets no point"
    there = found.vertices[found.names.index("head")]
    apart = (place(obj, there) - place(obj, vertex)).length / max(obj.dimensions)
    print("  vertex clicked:", vertex, "set:", there, f"apart: {apart:.4f}", flush=True)
    assert apart < 0.02, "another vertex was set"
    yield from hand.picture("10-limbs-fixed")

    yield from dragged(hand, obj, there)
    moved = points_by_hand(obj.data)
    assert moved.vertices != found.vertices, "the dot cannot be dragged"
    assert moved.names == found.names, "another dot was dragged"
    yield from hand.picture("10-limbs-dragged")
    yield from hand.press(
        "canonical_form_points(",
        happened=lambda: points_by_hand(figure().data) != moved,
        shares=(0.5,),
    )
    yield from hand.over_view()
    for _ in range(4):
        yield from hand.key("Z", ctrl=True)
        yield 0.7
    assert state(figure()) == before, "undo does not take the points back"


def dragged(hand, obj, vertex):
    """Drag the dot at a vertex along the surface."""
    region, view = hand.region("WINDOW"), hand.area().spaces.active.region_3d
    at = location_3d_to_region_2d(region, view, obj.matrix_world @ place(obj, vertex))
    x, y = region.x + at.x, region.y + at.y
    yield from hand.move(x - 30, y)
    yield 0.3
    yield from hand.move(x, y)
    yield 0.3
    hand.event("LEFTMOUSE", "PRESS")
    yield 0.1
    for step in range(1, 7):
        yield from hand.move(x + 3 * step, y)
        yield 0.05
    yield from hand.picture("10-limbs-dragging", at_once=True)
    hand.event("LEFTMOUSE", "RELEASE")
    yield 0.7


def place(obj, vertex):
    """Where the mesh shows a vertex."""
    return obj.data.vertices[vertex].co.copy()


def in_front(hand, obj):
    """A vertex that the view shows left of its middle: what a ray from the viewer meets first."""
    from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d

    region, view = hand.region("WINDOW"), hand.area().spaces.active.region_3d
    graph = bpy.context.evaluated_depsgraph_get()
    for x in np.linspace(0.1, 0.6, 40):
        at = (x * region.width, 0.5 * region.height)
        origin, direction = region_2d_to_origin_3d(region, view, at), region_2d_to_vector_3d(region, view, at)
        hit, where, _, face, found, _ = bpy.context.scene.ray_cast(graph, origin, direction)
        if hit and found.original == obj:
            corners = obj.data.polygons[face].vertices
            return min(corners, key=lambda each: (obj.data.vertices[each].co - where).length)
    raise AssertionError("the view does not show the body")
