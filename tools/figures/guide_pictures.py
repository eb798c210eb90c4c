"""Takes the user guide's pictures in a real window: `make guide-pictures`.

Run by Blender itself, as `session.py` is. Whenever the panel changes, the pictures are made anew.
"""

import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

PACKAGE, PICTURES, *_ = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :])
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "window"), str(ROOT)]

from tests.window.hand import Hand  # noqa: E402

HEADERS = {"features": 273, "distance": 299}  # of the closed panels before a run, below the top of the sidebar
hand = Hand(PICTURES)


def figure():
    return next(obj for obj in bpy.data.objects if obj.type == "MESH")


def in_view():
    return bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW"))


def run(name, **options):
    with in_view():
        getattr(bpy.ops.object, name)("EXEC_DEFAULT", True, **options)


def session():
    bpy.ops.extensions.package_install_files(
        filepath=str(PACKAGE), repo="user_default", enable_on_install=True, overwrite=True
    )
    yield from panels_on_a_bare_figure()
    yield from a_clothed_character()
    bpy.ops.screen.userpref_show("INVOKE_DEFAULT", section="EXTENSIONS")
    yield 2.0
    yield from hand.picture("0-preferences")


def panels_on_a_bare_figure():
    """Feature points and distances."""
    from tools.sample.posed_figure import build

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    build(levels=3)
    obj = figure()
    yield 1.0
    yield from open_tab()
    yield from hand.click(*hand.below_top(HEADERS["features"], 0.3))
    yield 0.5
    yield from hand.over_view()
    yield from hand.picture("2-feature-points")
    yield from hand.click(*hand.below_top(HEADERS["features"], 0.3))
    yield 0.5

    yield from hand.click(*hand.below_top(HEADERS["distance"], 0.3))
    points = np.array([vertex.co for vertex in obj.data.vertices])
    tip = int(np.argmin(points[:, 2]))
    for vertex in obj.data.vertices:
        vertex.select = vertex.index == tip
    bpy.context.scene.canonical_form.isolines = 16
    run("canonical_form_distance", kind="heat", isolines=16)
    hand.area().spaces.active.shading.color_type = "VERTEX"
    yield from hand.over_view()
    yield 0.5
    yield from hand.picture("3-distance")
    hand.area().spaces.active.shading.color_type = "MATERIAL"
    yield from hand.click(*hand.below_top(HEADERS["distance"], 0.3))
    yield 0.5


def a_clothed_character():
    """From the armature of several objects to the form, one limb, half-way."""
    from tools.sample.clothed_figure import build

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    armature = build(levels=3)
    armature.data.display_type = "STICK"
    yield 1.0
    for obj in bpy.context.view_layer.objects:
        obj.select_set(True)
    with in_view():
        bpy.ops.view3d.view_selected()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == armature)
    yield from hand.over_view()
    yield 0.7
    hand.area().spaces.active.region_3d.view_distance *= 1.25  # the form's arms reach higher
    yield from hand.picture("1-tab")

    bpy.context.scene.canonical_form.mesh = "SHOWN"
    with in_view():
        bpy.ops.object.canonical_form("INVOKE_DEFAULT", quality="full", memory_limit=1000.0, mesh="SHOWN")
    yield 6.0
    yield from hand.picture("4-running")
    yield from hand.over_view()
    yield from hand.key("ESC")
    yield 3.0
    with in_view():
        bpy.ops.object.canonical_form("INVOKE_DEFAULT", mesh="SHOWN")
    yield 15.0
    armature.hide_set(True)
    body = bpy.data.objects["Body"]
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    yield 0.7
    yield from hand.picture("5-form")

    points = np.array([vertex.co for vertex in body.data.vertices])
    heights = {}
    for group in body.vertex_groups:
        own = [
            vertex.index for vertex in body.data.vertices if any(part.group == group.index for part in vertex.groups)
        ]
        if group.name.startswith("Patch") and own:
            heights[int(group.name.split()[1])] = points[own, 2].mean()
    arm = sorted(heights, key=lambda number: -heights[number])[1]  # the head is higher
    run("canonical_form_limb", patch=arm, only=True)
    yield 1.0
    yield from hand.picture("6-one-limb")
    run("canonical_form_limb", patch=0)
    run("canonical_form_in_betweens", count=5)
    lead = next(obj for obj in bpy.data.objects if obj.type == "MESH" and leads(obj))
    keys = lead.data.shape_keys
    keys["Pose to Form"] = 0.5
    keys.update_tag()
    yield 1.0
    yield from hand.picture("7-half-way")


def leads(obj):
    """Whether the slider of this object moves the others."""
    data = obj.data.shape_keys.animation_data
    return not any(curve.data_path == '["Pose to Form"]' for curve in data.drivers)


def open_tab():
    """Look from the front, slightly above, and open the tab."""
    with in_view():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_orbit(angle=-0.5, type="ORBITLEFT")
        bpy.ops.view3d.view_orbit(angle=0.25, type="ORBITUP")
        bpy.ops.view3d.view_selected()
    yield from hand.over_view()
    if not hand.area().spaces.active.show_region_ui:
        yield from hand.key("N")
    yield 0.7
    hand.region("UI").active_panel_category = "Canonical Form"
    with in_view():
        bpy.ops.view3d.view_selected()
    yield 0.7


steps = session()


def proceed():
    try:
        return next(steps)
    except StopIteration:
        print("PICTURES TAKEN in Blender", bpy.app.version_string, flush=True)
        sys.stdout.flush()
        os._exit(0)
    except Exception:  # Blender would go on without an exit code
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(proceed, first_interval=3.0, persistent=True)
