"""Another's pose in the window: a T-pose, the pose of an object, the other side, and what is taken over."""

import bpy

ROWS = {"header": 274, "like": 310, "pose": 336, "mannequins": 362, "transfer": 534}  # below the top, without a result
PANELS = {"patches": 467, "result": 274}  # with a result: headers of the panels above, to be closed from below
SIDES, COLOURS = 466, 492  # then: Other Side, and Show Colours
SIDE = 0.3  # how far to the left a button of a row of two is


def poses(hand, figure, state, running, wait_for_the_end):
    """Click through the panel Pose Like; the mesh is as before at the end."""
    obj = figure()
    before = state(obj)
    yield from hand.over_view()
    yield from hand.click(*hand.below_top(ROWS["header"], 0.3))
    yield 0.7
    yield from hand.picture("12-pose-like")

    yield from click(hand, running, "mannequins")
    yield from hand.over_view()
    yield from hand.key("ESC")
    while running():
        yield 0.05
    yield 0.3
    assert state(obj) == before, "a cancelled T-pose leaves something behind"

    yield from click(hand, running, "mannequins")
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
    yield from hand.click(*hand.below_top(ROWS["like"], 0.7))
    yield 0.7
    for letter in "OTHER":
        yield from hand.key(letter)
    yield from hand.picture("14-reference")
    yield from hand.key("RET")
    yield 0.5
    assert bpy.context.scene.canonical_form.like == other.name, "the reference is not chosen"
    yield from click(hand, running, "pose")
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
    yield from click(hand, running, "transfer")
    yield from wait_for_the_end()
    assert "Hand" in obj.vertex_groups
    yield from hand.picture("15-transferred")
    yield from hand.over_view()
    yield from hand.key("Z", ctrl=True)
    yield 0.7
    obj = figure()
    assert state(obj) == before, "undo does not take back what was transferred"
    bpy.context.scene.canonical_form.like = ""
    bpy.data.objects.remove(bpy.data.objects["Other"])
    yield from hand.click(*hand.below_top(ROWS["header"], 0.3))
    yield 0.5


def other_side(hand, obj, other, running, wait_for_the_end):
    """Press Other Side and show the colours on the reference, with the panels above closed meanwhile."""
    for row in PANELS.values():
        yield from hand.click(*hand.below_top(row, 0.3))
        yield 0.7
    before = [tuple(point.co) for point in obj.data.shape_keys.key_blocks[1].data]
    yield from hand.picture("14-other-side")
    yield from hand.click_until(running, range(SIDES - 4, SIDES + 8, 4), 0.6)
    yield from wait_for_the_end()
    assert [tuple(point.co) for point in obj.data.shape_keys.key_blocks[1].data] != before, "the other side is the same"
    yield from hand.click_until(
        lambda: "Match Source" in other.data.color_attributes, range(COLOURS - 4, COLOURS + 8, 4), 0.6
    )
    yield from hand.picture("14-colours")
    yield from hand.click(*hand.below_top(COLOURS, 0.6))
    yield 0.7
    assert "Match Source" not in other.data.color_attributes, "the colours of the reference stay"
    for row in reversed(PANELS.values()):
        yield from hand.click(*hand.below_top(row, 0.3))
        yield 0.7


def click(hand, running, row):
    """Click on a button until the job runs."""
    place = SIDE if row == "mannequins" else 0.6
    yield from hand.over_view()
    yield from hand.click_until(running, range(ROWS[row] - 8, ROWS[row] + 14, 6), place)


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
