"""A session in a real Blender with a window: `make test-window BLENDER=… MESH=…`.

Run by Blender itself: ``blender --python tests/window/session.py -- ZIP MESH PICTURES``. Installs the zip, imports the
mesh, opens the tab, computes, undoes, redoes and clears, and compares the mesh after every step. Where ImageMagick's
``import`` is at hand it takes a picture of the screen at each step.
"""

import os
import shutil
import subprocess
import sys
import traceback
from pathlib import Path

import bpy

PACKAGE, MESH, PICTURES = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :])
WAIT = 1.5  # seconds between steps, for the window to be drawn
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
seen = {}


def view():
    """The 3D View of the window, as an override of the context."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "screen": window.screen, "area": area, "region": region}


def figure():
    return next(obj for obj in bpy.data.objects if obj.type == "MESH")


def picture(name):
    for area in view()["screen"].areas:
        area.tag_redraw()
    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=3)
    if shutil.which("import"):
        subprocess.run(["import", "-window", "root", str(PICTURES / f"{name}.png")], check=True)


def state():
    """Everything of the mesh that a run may touch; addresses change with undo, so values only."""
    obj, mesh = figure(), figure().data
    return {
        "vertices": [tuple(vertex.co) for vertex in mesh.vertices],
        "keys": mesh.shape_keys and {
            key.name: (key.value, [tuple(point.co) for point in key.data]) for key in mesh.shape_keys.key_blocks
        },
        "groups": [group.name for group in obj.vertex_groups],
        "colours": [colours.name for colours in mesh.color_attributes],
        "properties": sorted(mesh.keys()),
        "mode": obj.mode,
    }  # fmt: skip


def install():
    bpy.ops.extensions.package_install_files(
        filepath=str(PACKAGE), repo="user_default", enable_on_install=True, overwrite=True
    )
    bpy.data.batch_remove([*bpy.data.objects])
    bpy.ops.wm.obj_import(filepath=str(MESH))
    bpy.context.view_layer.objects.active = figure()
    bpy.ops.ed.undo_push(message="Import")


def open_tab():
    place = view()
    place["area"].spaces.active.show_region_ui = True
    place["area"].spaces.active.shading.color_type = "VERTEX"
    with bpy.context.temp_override(**place):
        bpy.ops.view3d.view_selected()


def choose_tab():
    sidebar = next(region for region in view()["area"].regions if region.type == "UI")
    sidebar.active_panel_category = "Canonical Form"
    sidebar.tag_redraw()


def before():
    seen["before"] = state()
    picture("panel-before")


def compute():
    with bpy.context.temp_override(**view()):
        assert bpy.ops.object.canonical_form("EXEC_DEFAULT", True) == {"FINISHED"}


def after():
    seen["after"] = state()
    assert "Canonical Form" in seen["after"]["keys"]
    picture("panel-after")


def undo():
    with bpy.context.temp_override(**view()):
        bpy.ops.ed.undo()


def undone():
    assert state() == seen["before"], "undo does not bring the mesh back"
    picture("undone")


def redo():
    with bpy.context.temp_override(**view()):
        bpy.ops.ed.redo()


def redone():
    assert state() == seen["after"], "redo does not bring the form back"


def clear():
    with bpy.context.temp_override(**view()):
        assert bpy.ops.object.canonical_form_clear("EXEC_DEFAULT", True) == {"FINISHED"}


def cleared():
    assert state() == seen["before"], "clear does not leave the mesh as it was"
    picture("cleared")
    print("WINDOW SESSION PASSED in Blender", bpy.app.version_string, flush=True)


steps = iter([install, open_tab, choose_tab, before, compute, after, undo, undone, redo, redone, clear, cleared])


def proceed():
    step = next(steps, None)
    try:
        if step is not None:
            print("step:", step.__name__, flush=True)
            step()
            return WAIT
    except Exception:  # a test outside pytest: show whatever went wrong and stop Blender
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)  # quit_blender would report success
    bpy.ops.wm.quit_blender()
    return None


PICTURES.mkdir(parents=True, exist_ok=True)
bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(proceed, first_interval=3.0, persistent=True)
