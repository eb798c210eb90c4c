"""Live update in the window: the form follows the slider of an option while it is dragged."""

from time import perf_counter

import bpy

LEFT = 0.6  # share of the width where the slider is taken hold of
DRAG = 60  # pixels


def live(hand, figure, state):
    """Start it on a mesh without a form, drag an option, undo, stop; the mesh is as before at the end."""
    options().quality = "draft"
    before = state(figure())
    bpy.ops.ed.undo_push(message="Before Live")
    yield from hand.over_view()
    yield 0.5
    header = yield from hand.unfold("canonical_form.preserve_detail", below=24)
    yield from hand.press("canonical_form_live(", happened=has_form(figure), seconds=4)
    yield 1.0
    first, detail = positions(figure()), options().preserve_detail
    yield from hand.picture("16-live")

    below, _ = yield from hand.find("canonical_form.preserve_detail")
    x, y = hand.below_top(below, LEFT)
    changes = [(perf_counter(), first)]
    yield from hand.move(x, y)
    hand.event("LEFTMOUSE", "PRESS")
    yield 0.05
    for each in range(DRAG // 3):
        yield from hand.move(x - 3 * each, y)
        yield 0.08
        now = positions(figure())
        if now != changes[-1][1]:
            changes.append((perf_counter(), now))
    yield from hand.picture("17-live-dragged", at_once=True)
    hand.event("LEFTMOUSE", "RELEASE")
    yield 1.5
    assert options().preserve_detail != detail, "the slider was not dragged"
    assert len(changes) > 3, f"the form did not follow: it changed {len(changes) - 1} times"
    last = positions(figure())
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.canonical_form("INVOKE_DEFAULT", quality="draft", preserve_detail=options().preserve_detail)
    yield 2.0
    assert positions(figure()) == last, "the live form is not that of the button"

    yield from hand.over_view()
    for _ in range(2):
        yield from hand.key("Z", ctrl=True)
        yield 1.2
    assert options().preserve_detail == detail, "undo does not bring the option back"
    assert positions(figure()) == first, "the form does not follow undo"
    yield from hand.picture("18-live-undone")

    bpy.ops.object.canonical_form_live("INVOKE_DEFAULT")
    yield 0.5
    options().preserve_detail = 0.2
    yield 1.0
    assert positions(figure()) == first, "it goes on after it was stopped"
    options().property_unset("preserve_detail")
    options().property_unset("quality")
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.object.canonical_form_clear()
    bpy.ops.ed.undo_push(message="After Live")  # operators that a script calls add no step
    yield 0.5
    assert state(figure()) == before, "clear leaves something behind"
    yield from hand.fold(header, "canonical_form.preserve_detail")
    return len(changes) - 1


def options():
    """The choices for the object, asked for anew: undo may free what was there before."""
    return bpy.context.object.canonical_form


def has_form(figure):
    """Tell, when asked, whether there is a form."""
    return lambda: figure().data.shape_keys is not None


def positions(obj):
    """The form's points."""
    return [tuple(point.co) for point in obj.data.shape_keys.key_blocks["Canonical Form"].data]
