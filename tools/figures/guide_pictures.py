"""Takes the screenshots of the user guide in a real window: `make guide-pictures`.

Run by Blender itself, like `session.py`. Run it again whenever the panel changes.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

PACKAGE, PICTURES, *_ = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :])
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "window"), str(ROOT)]

from tests.window.driving import drive  # noqa: E402
from tests.window.hand import Hand  # noqa: E402

RIG, TOOLS = 48, 74  # headers of closed panels before a run, in pixels below the wishes
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
    yield from a_fused_scan()
    yield from a_rig()
    yield from another_pose()
    yield from a_clothed_character()
    bpy.ops.screen.userpref_show("INVOKE_DEFAULT", section="EXTENSIONS")
    yield 2.0
    yield from hand.picture("0-preferences")


def panels_on_a_bare_figure():
    """Show feature points and distances."""
    from tools.sample.posed_figure import build

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    build(levels=3)
    obj = figure()
    yield 1.0
    yield from open_tab()
    run("canonical_form", step="FEATURES")
    run("canonical_form_fix_point", limb="right_foot", owner=obj.name, vertex=lowest(obj))
    yield from hand.over_view()
    yield 0.7
    yield from hand.picture("2-feature-points")
    run("canonical_form_points", how="FORGET")
    run("canonical_form_clear")
    yield 0.5
    header = yield from hand.unfold("canonical_form_mark(", below=TOOLS)
    yield from hand.scroll(12)
    tip = lowest(obj)
    for vertex in obj.data.vertices:
        vertex.select = vertex.index == tip
    obj.canonical_form.isolines = 16
    run("canonical_form_distance", kind="heat", isolines=16)
    hand.area().spaces.active.shading.color_type = "VERTEX"
    yield from hand.over_view()
    yield 0.5
    yield from hand.picture("3-distance")
    hand.area().spaces.active.shading.color_type = "MATERIAL"
    yield from hand.scroll(-12)
    yield from hand.fold(header, "canonical_form_mark(")


def show_colours(shown=True):
    """Tick the preference."""
    bpy.context.preferences.addons["bl_ext.user_default.canonical_form"].preferences.show_colours = shown


def lowest(obj):
    """The lowest vertex of a mesh: the tip of its right foot."""
    points = np.array([vertex.co for vertex in obj.data.vertices])
    return int(np.argmin(points[:, 2]))


def a_fused_scan():
    """Show where the skin of a scan has grown together, its form, and the marks."""
    from tests.window.contacts import members, scan, select

    bpy.data.batch_remove([*bpy.data.objects])
    obj = scan()
    show_colours()
    with in_view():
        bpy.ops.view3d.view_selected()
    yield from hand.over_view()
    yield 0.7
    hand.area().spaces.active.region_3d.view_distance *= 1.4  # the arms of the form reach higher
    with in_view():
        bpy.ops.object.canonical_form("INVOKE_DEFAULT")
    while "Contacts" not in obj.vertex_groups:  # half a minute, or minutes beside other work
        yield 0.5
    yield 1.0
    yield from hand.picture("13-contacts")
    found = members(obj, "Contacts")
    run("canonical_form_clear")
    header = yield from hand.unfold("canonical_form_mark(", below=TOOLS)
    with in_view():
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        bpy.ops.mesh.select_mode(type="FACE")
        bpy.ops.object.mode_set(mode="OBJECT")
        select(obj, found)
        chosen = np.isin(np.arange(len(obj.data.vertices)), found)
        for polygon in obj.data.polygons:
            polygon.select = bool(chosen[list(polygon.vertices)].all())
        bpy.ops.object.mode_set(mode="EDIT")
    yield from hand.over_view()
    yield 0.7
    yield from hand.picture("14-part-here")
    with in_view():
        bpy.ops.object.mode_set(mode="OBJECT")
    show_colours(False)
    bpy.data.batch_remove([*bpy.data.objects])
    figure_again()
    yield from hand.fold(header, "canonical_form_mark(")


def figure_again():
    """Build the sample's figure, so that there is a panel."""
    from tools.sample.posed_figure import build

    bpy.context.view_layer.update()
    build(levels=3)


def a_clothed_character():
    """Show several objects with an armature, their form, one limb, and the form half-way."""
    from tools.sample.clothed_figure import build

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    armature = build(levels=3)
    armature.data.display_type = "STICK"
    show_colours()
    yield 1.0
    for obj in bpy.context.view_layer.objects:
        obj.select_set(True)
    with in_view():
        bpy.ops.view3d.view_selected()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == armature)
    yield from hand.over_view()
    yield 0.7
    hand.area().spaces.active.region_3d.view_distance *= 1.25  # the arms of the form reach higher
    yield 0.7
    yield from hand.picture("1-tab")
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


def another_pose():
    """Show a posed figure in T-pose; then weights and rig transferred from a base mesh, and a pose of that rig."""
    from tools.sample.posed_figure import build, rig, skin

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    build(levels=3)
    scan = figure()
    scan.name = "Scan"
    yield from hand.over_view()
    run("canonical_form_pose_like", pose="T")
    hand.area().spaces.active.shading.color_type = "VERTEX"
    with in_view():
        bpy.ops.view3d.view_selected()
    yield 1.0
    yield from hand.picture("8-t-pose")
    run("canonical_form_clear")

    base = skin("Base", levels=2)
    armature = rig(base)
    armature.location.x, armature.show_in_front = 2.1, True  # the base mesh is its child
    bpy.context.view_layer.objects.active = scan
    for obj in bpy.data.objects:
        obj.select_set(obj == scan)
    scan.canonical_form.like = base
    header = yield from hand.unfold("canonical_form_transfer(", below=RIG)
    run("canonical_form_transfer", like=base.name, kinds={"GROUPS"})
    for name, turn in (("elbow.L", (0.0, 0.0, -0.9)), ("ankle.R", (1.1, 0.0, 0.0)), ("knee.R", (-0.9, 0.0, 0.0))):
        bone = armature.pose.bones[name]
        bone.rotation_mode, bone.rotation_euler = "XYZ", turn
    base.hide_set(True)
    for obj in (scan, armature):
        obj.select_set(True)
    hand.area().spaces.active.shading.color_type = "MATERIAL"
    with in_view():
        bpy.ops.view3d.view_selected()
    for obj in bpy.data.objects:
        obj.select_set(obj == scan)
    yield 1.0
    yield from hand.picture("9-rigged")
    scan.canonical_form.like = None
    yield from hand.fold(header, "canonical_form_transfer(")


def a_rig():
    """Show a posed figure without a rig, the same at rest in a T-pose with its new bones, and posed by them."""
    from tools.sample.posed_figure import build

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    build(levels=3)
    scan = figure()
    scan.name = "Scan"
    with in_view():
        bpy.ops.view3d.view_selected()
    header = yield from hand.unfold("canonical_form.rig_rest", below=RIG)
    yield from hand.over_view()
    yield 0.7
    yield from hand.picture("10-rig")
    yield from hand.fold(header, "canonical_form.rig_rest")
    run("canonical_form_rig", rest="T")
    armature = scan.modifiers[0].object
    with in_view():
        bpy.ops.view3d.view_selected()
    yield 1.0
    yield from hand.picture("11-rig-at-rest")
    turns = {"upper_arm.L": (0.0, 0.0, 1.1), "upper_arm.R": (0.0, 0.0, -0.6), "forearm.L": (0.9, 0.0, 0.0)}
    turns |= {"thigh.R": (-1.0, 0.0, 0.0), "shin.R": (1.2, 0.0, 0.0), "spine.002": (0.0, 0.3, 0.0)}
    for name, turn in turns.items():
        bone = armature.pose.bones[name]
        bone.rotation_mode, bone.rotation_euler = "XYZ", turn
    bpy.context.view_layer.objects.active = armature
    armature.select_set(True)
    with in_view():
        bpy.ops.object.mode_set(mode="POSE")
    yield 1.0
    yield from hand.picture("12-rig-in-pose-mode")
    with in_view():
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    build(levels=3)  # so that there is a panel
    yield 0.7


def leads(obj):
    """Return whether the slider of this object moves the other objects."""
    data = obj.data.shape_keys.animation_data
    return not any(curve.data_path == '["Pose to Form"]' for curve in data.drivers)


def open_tab():
    """Set a view from slightly to the right of the front and above, and open the tab."""
    with in_view():
        bpy.ops.view3d.view_axis(type="FRONT")
    yield 0.7
    upright = Euler((np.pi / 2 - 0.25, 0.0, 0.5))  # two orbits in a row would tilt the horizon
    hand.area().spaces.active.region_3d.view_rotation = upright.to_quaternion()
    yield from hand.over_view()
    if not hand.area().spaces.active.show_region_ui:
        yield from hand.key("N")
    yield 0.7
    hand.region("UI").active_panel_category = "Canonical Form"
    with in_view():
        bpy.ops.view3d.view_selected()
    yield from hand.move(*hand.below_top(300, 0.3))  # the tab takes no click before it is drawn
    yield 1.5


drive(session(), "PICTURES TAKEN")
