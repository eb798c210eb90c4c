"""Another's pose in the window: a T-pose, the pose of an object, the other side, and what is taken over."""

import bpy


def poses(hand, figure, state, running, wait_for_the_end):
    """Click through the panel Pose Like; the mesh is as before at the end."""
    obj = figure()
    before = state(obj)
    yield from hand.press_wish("T", running)
    yield from hand.picture("12-t-pose-running", at_once=True)
    yield from hand.over_view()
    yield from hand.key("ESC")
    while running():
        yield 0.05
    yield 0.3
    assert state(obj) == before, "a cancelled T-pose leaves something behind"

    yield from hand.press_wish("T", running)
    yield from wait_for_the_end()
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "T-Pose"]
    assert obj.data.color_attributes.active_color_name == "Match"
    yield from hand.picture("13-t-pose")
    yield from hand.over_view()
    yield from hand.key("Z", ctrl=True)
    yield 0.7
    obj = figure()
    assert state(obj) == before, "undo does not take the T-pose back"

    other = reference(obj)
    yield 0.5
    yield from hand.press("canonical_form.like")
    yield 0.7
    for letter in "OTHER":
        yield from hand.key(letter)
    yield from hand.picture("14-reference")
    yield from hand.key("RET")
    yield 0.5
    assert obj.canonical_form.like == other, "the reference is not chosen"
    yield from hand.press_wish("like", running)
    yield from wait_for_the_end()
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", f"Like {other.name}"]
    yield from hand.picture("14-like-another")
    yield from other_side(hand, obj, other, running, wait_for_the_end)
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.canonical_form_clear()
    yield 0.7
    assert state(obj) == before, "clear does not take the pose back"

    other.vertex_groups.new(name="Hand").add(list(range(40)), 1.0, "REPLACE")
    bpy.ops.ed.undo_push(message="Group")
    yield 0.5
    header = yield from hand.unfold("canonical_form_transfer(", below=48)
    yield from hand.scroll(12)
    hand.known.clear()
    yield from hand.press("canonical_form_transfer(", happened=running)
    yield from hand.scroll(-12)
    hand.known.clear()
    yield from wait_for_the_end()
    assert "Hand" in obj.vertex_groups
    yield from hand.picture("15-transferred")
    yield from hand.over_view()
    yield from hand.key("Z", ctrl=True)
    yield 0.7
    obj = figure()
    assert state(obj) == before, "undo does not take back what was transferred"
    obj.canonical_form.like = None
    bpy.data.objects.remove(bpy.data.objects["Other"])
    yield from hand.fold(header, "canonical_form_transfer(")


def other_side(hand, obj, other, running, wait_for_the_end):
    """Press Other Side, and show the colours on the reference."""
    before = [tuple(point.co) for point in obj.data.shape_keys.key_blocks[1].data]
    yield from hand.picture("14-other-side")
    yield from hand.press("canonical_form_pose_like(", "side=1", happened=running)
    yield from wait_for_the_end()
    assert [tuple(point.co) for point in obj.data.shape_keys.key_blocks[1].data] != before, "the other side is the same"
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.canonical_form_match_colours(like=other.name)
    assert "Match Source" in other.data.color_attributes
    yield from hand.picture("14-colours")
    bpy.ops.object.canonical_form_match_colours(like=other.name)
    assert "Match Source" not in other.data.color_attributes, "the colours of the reference stay"


def reference(obj):
    """Add the same body, turned, beside it."""
    other = obj.copy()
    other.data = obj.data.copy()
    other.name = "Other"
    bpy.context.scene.collection.objects.link(other)
    other.location.x += 3.0
    other.rotation_euler.z = 0.8
    other.select_set(False)
    return other
