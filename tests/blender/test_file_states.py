"""States that an artist's file can be in: the run works, or refuses with a sentence, and changes nothing else."""

import stat

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_mesh
from addon.blender.objects.object_warnings import object_warnings
from addon.blender.records.record import require_record
from tests.blender.conftest import QUICK, add_object, flat, snapshot
from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")


def in_mode(mode):
    return lambda obj, _: bpy.ops.object.mode_set(mode=mode)


def hidden(obj, _):
    obj.hide_set(True)


def library(obj, folder):
    path = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes])
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Figure"]
    linked = bpy.data.objects["Figure"]
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.view_layer.objects.active = linked
    return linked


def override(obj, folder):
    linked = library(obj, folder)
    local = linked.override_create(remap_local_usages=True)
    bpy.context.view_layer.objects.active = local
    return local


def multi_user(obj, _):
    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.scene.collection.objects.link(twin)


def smile(obj):
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Smile", from_mix=False)
    key.data[0].co.x += 0.1
    key.value = 0.5
    return key


def locked_key(obj, _):
    smile(obj).lock_shape = True


def our_key_locked(obj, _):
    bpy.ops.object.canonical_form(**QUICK)
    obj.data.shape_keys.key_blocks["Canonical Form"].lock_shape = True


def muted_key(obj, _):
    smile(obj).mute = True


def driven_key(obj, _):
    driver = smile(obj).driver_add("value").driver
    driver.expression = "frame / 10"
    bpy.context.view_layer.update()


def absolute_keys(obj, _):
    smile(obj)
    obj.data.shape_keys.use_relative = False


def basis_renamed(obj, _):
    smile(obj)
    obj.data.shape_keys.key_blocks[0].name = "Ausgangsform"


def basis_moved_down(obj, _):
    smile(obj)
    obj.active_shape_key_index = 0
    bpy.ops.object.shape_key_move(type="DOWN")


def modifier(kind, **options):
    def add(obj, _):
        made = obj.modifiers.new(kind.title(), kind)
        for name, value in options.items():
            setattr(made, name, value)

    return add


def armature(obj, _):
    from tests.blender.test_tools import bent

    bent(obj)


def multires(obj, _):
    obj.modifiers.new("Multires", "MULTIRES")
    bpy.ops.object.multires_subdivide(modifier="Multires")


def scaled(*scale):
    def change(obj, _):
        obj.scale = scale
        bpy.context.view_layer.update()

    return change


def without_faces(obj, _):
    import bmesh

    edited = bmesh.new()
    edited.from_mesh(obj.data)
    bmesh.ops.delete(edited, geom=edited.faces[:], context="FACES_ONLY")
    edited.to_mesh(obj.data)
    edited.free()


def loose_vertices(obj, _):
    obj.data.vertices.add(3)


def two_parts(obj, _):
    vertices, faces = shapes.sphere(1)
    other = bpy.data.meshes.new("Ball")
    other.from_pydata((vertices + 9).tolist(), [], faces.tolist())
    ball = bpy.data.objects.new("Ball", other)
    bpy.context.scene.collection.objects.link(ball)
    ball.select_set(True)
    bpy.ops.object.join()


def ngons(obj, _):
    obj.modifiers.new("Flat", "DECIMATE").decimate_type = "DISSOLVE"
    obj.modifiers["Flat"].angle_limit = 0.3
    bpy.ops.object.modifier_apply(modifier="Flat")
    assert max(len(polygon.vertices) for polygon in obj.data.polygons) > 4


def flat_faces(obj, _):
    faces = [polygon.vertices[:] for polygon in obj.data.polygons][:40]
    for one, two, three in faces:
        obj.data.vertices[three].co = obj.data.vertices[one].co.lerp(obj.data.vertices[two].co, 0.5)


def coincident(obj, _):
    one, two, _ = obj.data.polygons[0].vertices
    obj.data.vertices[one].co = obj.data.vertices[two].co


def moved(distance):
    def change(obj, _):
        for vertex in obj.data.vertices:
            vertex.co.x += distance

    return change


def tiny(obj, _):
    for vertex in obj.data.vertices:
        vertex.co *= 1e-5


def emoji(obj, _):
    obj.name = "🦄 Ünïcode"
    obj.data.name = "🦄"


def forty_groups(obj, _):
    for number in range(40):
        obj.vertex_groups.new(name=f"Bone {number}").add([number, number + 50], 0.5, "REPLACE")
    obj.vertex_groups.active_index = 17


def animated(obj, _):
    key = smile(obj)
    key.keyframe_insert("value", frame=1)
    key.value = 1.0
    key.keyframe_insert("value", frame=20)
    obj.keyframe_insert("location", frame=1)
    obj.location.x = 5
    obj.keyframe_insert("location", frame=20)
    bpy.context.scene.frame_set(10)


def read_only(obj, folder):
    path = folder / "kept.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    path.chmod(stat.S_IRUSR)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    bpy.context.view_layer.objects.active = bpy.data.objects["Figure"]


def not_a_number(obj, _):
    obj.data.vertices[5].co.x = float("nan")


def fake_user(obj, _):
    obj.data.use_fake_user = True


def in_local_view_of_a_collection_that_is_off(obj, _):
    collection = bpy.data.collections.new("Off")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    bpy.context.view_layer.layer_collection.children["Off"].hide_viewport = True
    bpy.context.view_layer.objects.active = obj


WORKS = None
STATES = {
    "Edit Mode": (in_mode("EDIT"), WORKS),
    "Sculpt Mode": (in_mode("SCULPT"), WORKS),
    "Weight Paint": (in_mode("WEIGHT_PAINT"), WORKS),
    "hidden": (hidden, WORKS),
    "in a hidden collection": (in_local_view_of_a_collection_that_is_off, WORKS),
    "linked": (library, "linked from another file.*Make Local"),
    "library override": (override, "linked from another file.*Make Local"),
    "multi-user": (multi_user, WORKS),
    "fake user": (fake_user, WORKS),
    "locked shape key": (locked_key, WORKS),
    "our shape key locked": (our_key_locked, "is locked. Unlock it"),
    "muted key": (muted_key, WORKS),
    "driven key": (driven_key, WORKS),
    "absolute shape keys": (absolute_keys, "absolute. Tick Relative"),
    "Basis renamed": (basis_renamed, WORKS),
    "Basis moved down": (basis_moved_down, WORKS),
    "mirror modifier": (modifier("MIRROR"), WORKS),
    "subdivision modifier": (modifier("SUBSURF", levels=2), WORKS),
    "armature in pose": (armature, WORKS),
    "multires": (multires, WORKS),
    "non-uniform scale": (scaled(1, 1, 3), WORKS),
    "negative scale": (scaled(-1, 1, 1), WORKS),
    "zero scale": (scaled(0, 0, 0), WORKS),
    "no faces": (without_faces, "has no faces"),
    "loose vertices": (loose_vertices, WORKS),
    "two loose parts": (two_parts, WORKS),
    "n-gons": (ngons, WORKS),
    "0-area faces": (flat_faces, WORKS),
    "vertices in one place": (coincident, WORKS),
    "huge offset": (moved(1e4), WORKS),
    "tiny scale": (tiny, WORKS),
    "an emoji in the name": (emoji, WORKS),
    "40 groups": (forty_groups, WORKS),
    "animated": (animated, WORKS),
    "read-only file": (read_only, WORKS),
    "not a number": (not_a_number, "not numbers. Delete or repair"),
}


def everything():
    """Names of all data in the file, and what of the scene a user may care about."""
    scene = bpy.context.scene
    return {
        **{kind: sorted(each.name for each in getattr(bpy.data, kind)) for kind in (
            "objects", "meshes", "shape_keys", "actions", "armatures", "materials", "collections", "scenes",
        )},
        "frame": scene.frame_current,
        "selected": sorted(obj.name for obj in bpy.context.selected_objects),
        "active": bpy.context.view_layer.objects.active and bpy.context.view_layer.objects.active.name,
        "objects' own": [
            (obj.mode, str(obj.matrix_world), [(each.name, each.show_viewport) for each in obj.modifiers])
            for obj in bpy.data.objects
        ],
    }  # fmt: skip


@pytest.mark.parametrize("state", STATES)
def test_a_run_works_or_refuses_and_changes_nothing_else(figure_object, state, tmp_path):
    prepare, sentence = STATES[state]
    prepare(figure_object, tmp_path)
    obj = bpy.context.view_layer.objects.active
    before, around = snapshot(obj), everything()
    if sentence is not None:
        with pytest.raises(RuntimeError, match=sentence):
            bpy.ops.object.canonical_form(**QUICK)
        assert snapshot(obj) == before
        assert everything() == around
        return
    assert bpy.ops.object.canonical_form(**QUICK) == {"FINISHED"}
    record, during = require_record(obj.data), snapshot(obj)
    assert during["mode"] == before["mode"]
    assert record.report.vertices == len(obj.data.vertices)
    for name, key in (before["keys"] or {}).items():
        assert during["keys"][name] == key
    assert during["groups"][: len(before["groups"])] == before["groups"]
    assert during["vertices"] == before["vertices"]
    key = obj.data.shape_keys.key_blocks[next(iter(record.keys))]
    points = np.frombuffer(flat(key.data, "co", 3), np.float32)
    assert np.isfinite(points).all()
    rest = read_mesh(obj.data)[0] if obj.mode == "OBJECT" else None
    if rest is not None:
        assert np.ptp(points.reshape(-1, 3), axis=0).max() == pytest.approx(np.ptp(rest, axis=0).max(), rel=0.8)
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert snapshot(obj) == before
    assert everything() == around


@pytest.mark.parametrize(
    ("state", "words"),
    [
        ("non-uniform scale", "scale of Figure is not uniform"),
        ("armature in pose", "pose that you see: Rig of"),
        ("mirror modifier", None),
        ("subdivision modifier", None),
        ("multires", None),
        ("negative scale", None),
    ],
)
def test_a_warning_tells_what_does_not_enter_the_form(figure_object, state, words, tmp_path):
    STATES[state][0](figure_object, tmp_path)
    bpy.ops.object.canonical_form(**QUICK)
    warnings = [
        each for each in require_record(figure_object.data).report.warnings if "scale" in each or "modifiers" in each
    ]
    assert (words is None and not warnings) or words in warnings[0]


def test_a_warning_tells_of_other_keys_that_bend_the_form(figure_object):
    basis = figure_object.shape_key_add(name="Basis")
    for name, value, muted in (
        ("Bends", 0.5, False),
        ("Still", 0.0, False),
        ("Muted", 1.0, True),
        ("Same", 1.0, False),
    ):
        key = figure_object.shape_key_add(name=name, from_mix=False)
        key.value, key.mute = value, muted
        if name != "Same":
            key.data[0].co.x += 1.0
    bpy.ops.object.canonical_form(**QUICK)
    told = [each for each in require_record(figure_object.data).report.warnings if "shape keys" in each]
    assert len(told) == 1
    assert "pose that you see: Bends of" in told[0]
    figure_object.data.shape_keys.key_blocks["Bends"].value = 0.0
    for _ in range(2):  # the second time with the form of the first, which bends
        bpy.ops.object.canonical_form(**QUICK)
        assert not [each for each in require_record(figure_object.data).report.warnings if "shape keys" in each]
    assert basis.name == "Basis"


def test_several_objects_have_one_warning_of_a_kind(figure_object, tmp_path):
    STATES["armature in pose"][0](figure_object, tmp_path)
    other = figure_object.copy()
    other.data = figure_object.data.copy()
    bpy.context.scene.collection.objects.link(other)
    told = object_warnings([figure_object, other], False, scaled=True)
    assert len(told) == 1
    assert f"{figure_object.name}, {other.name}" in told[0]
    assert told[0].count("Rig") == 1


def test_every_other_tool_refuses_what_the_run_refuses(blender):
    add_object("Points", np.eye(3), [])
    for name in ("canonical_form_choose", "canonical_form_distance"):
        with pytest.raises(RuntimeError, match="has no faces"):
            getattr(bpy.ops.object, name)()
    for name in ("canonical_form_limb", "canonical_form_in_betweens", "canonical_form_clear"):
        with pytest.raises(RuntimeError, match="no canonical form"):
            getattr(bpy.ops.object, name)()
    with pytest.raises(RuntimeError, match="no patches"):
        bpy.ops.object.canonical_form_select_patch()
    with pytest.raises(RuntimeError, match="Nothing is being computed"):
        bpy.ops.object.canonical_form_cancel()
