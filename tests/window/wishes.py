"""Every wish by mouse on bodies of your own, with a picture of each: `run.py --session tests/window/wishes.py`.

Run by Blender itself, as `session.py` is; --character names a file (.glb, .obj or .ply), or a folder of some. Says for
each wish whether it was granted, and how long it took.
"""

import importlib
import sys
from pathlib import Path
from time import perf_counter

import bpy

PACKAGE, PICTURES, *FILES = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :])
sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[2])]

from tests.window.driving import drive  # noqa: E402
from tests.window.hand import UNIT, Hand  # noqa: E402
from tests.window.opening import IMPORTERS, import_file  # noqa: E402

LONGEST = 240  # seconds of a wish
hand = Hand(PICTURES)


def files():
    """List the files, those of folders too."""
    inside = [each for path in FILES for each in (sorted(path.iterdir()) if path.is_dir() else [path])]
    return [path for path in inside if path.suffix in IMPORTERS]


def running():
    kinds = bpy.types.Operator.__subclasses__()
    cancel = next((each for each in kinds if each.__name__ == "OBJECT_OT_canonical_form_cancel"), None)
    return cancel is not None and cancel.job is not None


def session():
    """Grant every wish on every file."""
    bpy.ops.extensions.package_install_files(
        filepath=str(PACKAGE), repo="user_default", enable_on_install=True, overwrite=True
    )
    yield from open_tab()
    for path in files():
        yield from wishes_of(path)


def open_tab():
    """Open the tab once; it stays."""
    yield from hand.over_view()
    if not hand.area().spaces.active.show_region_ui:
        yield from hand.key("N")
    yield 0.7
    tabs = hand.region("UI")
    for below in range(20, 400, 20):
        yield from hand.click(tabs.x + tabs.width - 0.6 * UNIT, tabs.y + tabs.height - below)
        yield 0.3
        if tabs.active_panel_category == "Canonical Form":
            return
    raise AssertionError("the tab was not found")


def wishes_of(path):
    """Import a file as Blender does, and press every wish with a result of its own."""
    bpy.data.batch_remove([*bpy.data.objects])
    import_file(path)
    meshes = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.visible_get()]
    rigs = [obj for obj in bpy.data.objects if obj.type == "ARMATURE"]
    print(f"{path.stem}: {sum(len(obj.data.vertices) for obj in meshes)} vertices, {len(meshes)} meshes", flush=True)
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    for rig in rigs:
        rig.hide_set(True)
    bpy.ops.ed.undo_push(message="Import")
    yield 1.5
    yield from hand.picture(f"{path.stem}-0")
    for wish in ("T", "A", "straighten", "like", "rig"):
        if wish == "like":
            yield from choose(reference(meshes))
        began = perf_counter()
        yield from hand.press_wish(wish, None)
        for _ in range(75):  # what is refused does not start
            if running() or made(meshes):
                break
            yield 0.02
        while running():
            assert perf_counter() - began < LONGEST, f"{wish} does not end"
            yield 0.1
        yield 1.0
        done = made(meshes)
        print(f"  {wish}: {'granted' if done else 'refused'} in {perf_counter() - began - 1:.1f} s", flush=True)
        yield from hand.picture(f"{path.stem}-{wish}")
        yield from hand.close_message()
        if done:
            yield from hand.over_view()
            yield from hand.key("Z", ctrl=True)
            yield 1.0
            meshes = [bpy.data.objects[obj] for obj in [each.name for each in bpy.data.objects] if is_shown(obj)]
            assert not made(meshes), f"undo does not take {wish} back"


def reference(meshes):
    """Add a mannequin with lowered arms beside the body, which takes its pose."""
    core = importlib.import_module("bl_ext.user_default.canonical_form.addon.core")
    vertices, faces = core.mannequin(40.0)
    mesh = bpy.data.meshes.new("Other")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    other = bpy.data.objects.new("Other", mesh)
    bpy.context.scene.collection.objects.link(other)
    other.location.x = max(obj.matrix_world.translation.x + max(obj.dimensions) for obj in meshes)
    bpy.ops.ed.undo_push(message="Reference")
    return other


def choose(other):
    """Choose the object whose pose is wished for, by its name."""
    yield 1.0
    yield from hand.press("canonical_form.like")
    yield 0.7
    for letter in other.name.upper():
        yield from hand.key(letter)
    yield from hand.key("DOWN_ARROW")  # names that are only like it are offered, too
    yield from hand.key("RET")
    yield 0.7


def is_shown(name):
    """Return whether an object is one of the meshes."""
    obj = bpy.data.objects[name]
    return obj.type == "MESH" and obj.visible_get() and name != "Other"


def made(meshes):
    """Return whether a mesh has a result of a wish."""
    return any(name.startswith("canonical_form") for obj in meshes for name in obj.data.keys())  # noqa: SIM118


drive(session(), "WISHES GRANTED", PICTURES)
