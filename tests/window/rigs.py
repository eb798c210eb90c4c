"""A rig in the window: made by a click, posed, undone, made again, saved with the file, and removed."""

import bpy
import numpy as np


def rigs(hand, figure, state, running, wait_for_the_end):
    """Click through the panel Rig; the mesh is as before at the end."""
    obj = figure()
    before = state(obj)
    yield from hand.press_wish("rig", running)
    yield from hand.over_view()
    yield from hand.key("ESC")
    while running():
        yield 0.05
    yield 0.3
    assert state(obj) == before, "a cancelled rig leaves something behind"

    yield from hand.press_wish("rig", running)
    yield from wait_for_the_end()
    armature = obj.modifiers[0].object
    assert len(armature.data.bones) == 22
    yield from hand.picture("16-rigged")
    there = shown(obj)
    layer = bpy.context.view_layer
    layer.objects.active = armature
    armature.select_set(True)
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.mode_set(mode="POSE")
        for name, angle in (("upper_arm.L", 0.9), ("forearm.L", 0.8), ("thigh.R", -0.7), ("shin.R", 0.9)):
            bone = armature.pose.bones[name]
            bone.rotation_mode = "XYZ"
            bone.rotation_euler.x = angle
        yield 0.7
        yield from hand.picture("16-posed-by-its-rig")
        moved = np.linalg.norm(shown(obj) - there, axis=1) / np.ptp(there, axis=0).max()
        assert moved.max() > 0.1, "the bones move nothing"
        bpy.ops.object.mode_set(mode="OBJECT")
    armature.select_set(False)
    layer.objects.active = obj
    obj.select_set(True)
    yield 0.5
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        assert bpy.ops.object.canonical_form_rig_clear() == {"FINISHED"}
        bpy.ops.ed.undo_push(message="Remove Rig")  # operators that a script calls add no step
    yield 0.7
    assert state(obj) == before, "Remove Rig does not take the rig back"
    assert "Rig of Figure" not in bpy.data.armatures, "Remove Rig leaves the armature"

    yield from hand.press_wish("rig", running)
    yield from wait_for_the_end()
    assert obj.modifiers[0].object.type == "ARMATURE"
    yield from hand.over_view()
    yield from hand.key("Z", ctrl=True)
    yield 0.7
    obj = figure()
    assert state(obj) == before, "undo does not take the rig back"
    assert not obj.modifiers, "undo leaves a modifier"


def shown(obj):
    """Positions with modifiers."""
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    return points
