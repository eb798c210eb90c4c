"""Skin that has grown together, in the window: found and shown, marked by hand, cut on a new object."""

import bpy
import numpy as np


def contacts(hand, state, compute, wait_for_the_end):
    """A figure whose arms and legs have grown together: its contacts are found, then marked instead."""
    bpy.data.batch_remove([*bpy.data.objects])
    obj = scan()
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.view3d.view_selected()
    bpy.ops.ed.undo_push(message="Scan")
    yield 0.7
    before = state(obj)
    yield from compute()
    assert "Contacts" in obj.vertex_groups, "nothing was found"
    found, opened = members(obj, "Contacts"), form(obj)
    assert len(found) > 100
    yield from hand.picture("17-contacts-found")
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.canonical_form_clear()
    yield 0.7
    assert state(obj) == before, "Clear does not take the form back"

    obj.canonical_form.contacts = "keep"
    hand.region("UI").tag_redraw()
    yield 0.3
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        bpy.ops.object.mode_set(mode="OBJECT")
        select(obj, found)
        bpy.ops.object.mode_set(mode="EDIT")
    yield 0.5
    header = yield from hand.unfold("canonical_form_mark(", "marks='PART'", below=74)
    yield from hand.picture("17-selected")
    yield from hand.press("canonical_form_mark(", "marks='PART'", happened=lambda: "Part Here" in obj.vertex_groups)
    assert obj.mode == "EDIT", "marking leaves Edit Mode"
    yield from hand.over_view()
    yield from hand.key("TAB")
    yield 0.5
    assert members(obj, "Part Here") == found
    obj.canonical_form.result = "OBJECT"
    hand.region("UI").tag_redraw()  # the button has the choices of when it was drawn
    yield 0.3
    yield from compute()
    made = bpy.context.view_layer.objects.active
    assert made != obj, "the result is not on a new object"
    assert len(made.data.vertices) > len(obj.data.vertices), "the new object is not cut"
    width = np.ptp(form(made), axis=0)[0]
    assert width > 0.8 * np.ptp(opened, axis=0)[0], "the arms are not spread"
    obj.hide_set(True)
    yield from hand.picture("17-cut-and-capped")
    obj.hide_set(False)
    bpy.context.view_layer.objects.active = obj
    for each in bpy.data.objects:
        each.select_set(each == obj)
    yield 0.5
    yield from hand.fold(header, "canonical_form_mark(", "marks='PART'")


def scan():
    """Add a fused figure, and make it active."""
    from tests.meshes.fused import fused_figure  # needs scipy, which comes with the extension

    vertices, faces, _ = fused_figure(86.0, 0.015)
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Scan", mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def members(obj, name):
    """Vertices of a group."""
    number = obj.vertex_groups[name].index
    return [each.index for each in obj.data.vertices if any(part.group == number for part in each.groups)]


def select(obj, vertices):
    """Select vertices, and what lies between them."""
    chosen = np.zeros(len(obj.data.vertices), dtype=bool)
    chosen[vertices] = True
    obj.data.vertices.foreach_set("select", chosen)


def form(obj):
    """Positions of the form."""
    points = obj.data.shape_keys.key_blocks["Canonical Form"].points
    found = np.empty((len(points), 3), dtype=np.float32)
    points.foreach_get("co", found.ravel())
    return found
