"""Results of .blend files with several scenes, sheared objects, objects in Edit Mode, frames computed twice."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.blender.files.reading_files import open_meshes
from addon.blender.mesh_items.action_curves import curves_of
from addon.blender.results.result_clearing import clear_from
from tests.meshes import shapes

from .conftest import add_object
from .test_batch_files import run

pytestmark = pytest.mark.usefixtures("computed_once")


@pytest.fixture
def figure(blender, arrays):
    return add_object("Figure", *arrays)


def saved(tmp_path):
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def in_scene(obj):
    return np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])


@pytest.mark.parametrize("kind", ["glb", "usdc"])
def test_objects_of_other_scenes_stay_out(figure, arrays, tmp_path, kind):
    other = add_object("Other", *arrays)
    bpy.context.scene.collection.objects.unlink(other)
    scene = bpy.data.scenes.new("Second")
    scene.collection.objects.link(other)
    scene.view_layers[0].update()
    other.select_set(True, view_layer=scene.view_layers[0])
    code, [line] = run(saved(tmp_path), "--output", tmp_path / "out", "--format", kind, "--objects", "Figure")
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    assert "Other" not in obj.name


@pytest.mark.parametrize("kind", ["glb", "fbx"])
def test_sheared_objects_are_written_as_they_stand(figure, tmp_path, kind):
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (1.0, 1.0, 3.0)
    figure.parent, figure.rotation_euler = parent, (0.8, 0.3, 0.0)
    path = saved(tmp_path)
    code, [line] = run(path, "--output", tmp_path / "out", "--format", kind)
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    written = in_scene(obj)
    code, [line] = run(path, "--output", tmp_path / "blend")
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    form = np.array([obj.matrix_world @ point.co for point in obj.data.shape_keys.key_blocks["Canonical Form"].data])
    for one, two in zip(written.T, form.T, strict=True):
        np.testing.assert_allclose([one.min(), one.max()], [two.min(), two.max()], atol=1e-3)


def test_faces_without_a_material_do_not_take_that_of_others(figure, tmp_path):
    for material in (bpy.data.materials.new("Red"), None):
        figure.data.materials.append(material)
    red = np.arange(len(figure.data.polygons)) % 3 == 0
    figure.data.polygons.foreach_set("material_index", (~red).astype(np.int32))
    code, [line] = run(saved(tmp_path), "--output", tmp_path / "out", "--format", "obj")
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    names = [obj.data.materials[polygon.material_index].name for polygon in obj.data.polygons]
    np.testing.assert_array_equal([name.startswith("Red") for name in names], red)


def test_a_file_saved_while_several_objects_are_edited_is_computed(figure, arrays, tmp_path):
    other = add_object("Other", arrays[0] + [9.0, 0.0, 0.0], arrays[1])
    figure.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    assert (figure.mode, other.mode) == ("EDIT", "EDIT")
    code, lines = run(saved(tmp_path), "--output", tmp_path / "out")
    assert code == 0, lines
    assert sorted(line["object"] for line in lines) == ["Figure", "Other"]


def shown_by_frame(path):
    """The values of the shape keys of the figure at frames 1 to 3."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    keys, values = bpy.data.objects["Figure"].data.shape_keys.key_blocks, []
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        values.append({key.name: round(key.value, 3) for key in keys if key.value and key.name != "Basis"})
    return values


def test_frames_are_computed_again_on_their_own_result(figure, tmp_path):
    bpy.ops.object.canonical_form(max_iterations=2, landmark_count=12)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    words = ("--frames", "1:3", "--frames-as", "keys", "--output")
    each = [{f"Canonical Form {frame}": 1.0} for frame in (1, 2, 3)]
    code, lines = run(saved(tmp_path), *words, tmp_path / "first")
    assert code == 0
    assert shown_by_frame(lines[0]["output"]) == each
    code, lines = run(lines[0]["output"], *words, tmp_path / "second")
    assert code == 0
    assert shown_by_frame(lines[0]["output"]) == each
    obj = bpy.data.objects["Figure"]
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.canonical_form(max_iterations=2, landmark_count=12)
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "Canonical Form"]
    assert clear_from(obj) == []
    assert obj.data.shape_keys is None


def with_keys_of_frames(frames, tmp_path):
    """The figure in the file that a run with a key per frame wrote."""
    code, lines = run(saved(tmp_path), "--frames", frames, "--frames-as", "keys", "--output", tmp_path / "out")
    assert code == 0
    bpy.ops.wm.open_mainfile(filepath=lines[0]["output"])
    return bpy.data.objects["Figure"]


def test_frames_leave_no_curves_behind_and_those_of_other_keys_stay(figure, tmp_path):
    figure.shape_key_add(name="Basis")
    own = figure.shape_key_add(name="Smile")
    own.keyframe_insert("value", frame=1)
    obj = with_keys_of_frames("1:3:2", tmp_path)
    animated = ['key_blocks["Canonical Form 1"].value', 'key_blocks["Canonical Form 3"].value']
    mine = 'key_blocks["Smile"].value'
    assert sorted(curve.data_path for curve in curves_of(obj.data.shape_keys.animation_data.action)) == [
        *animated,
        mine,
    ]
    assert clear_from(obj) == []
    assert [curve.data_path for curve in curves_of(obj.data.shape_keys.animation_data.action)] == [mine]


def test_one_frame_as_a_key_leaves_no_curves_behind(figure, tmp_path):
    obj = with_keys_of_frames("5:5", tmp_path)
    action = obj.data.shape_keys.animation_data.action
    assert [curve.data_path for curve in curves_of(action)] == ['key_blocks["Canonical Form 5"].value']
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.canonical_form(max_iterations=2, landmark_count=12)
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "Canonical Form"]
    assert list(curves_of(action)) == []
    assert clear_from(obj) == []
    assert obj.data.shape_keys is None


def test_one_frame_as_a_key_can_be_cleared(figure, tmp_path):
    obj = with_keys_of_frames("5:5", tmp_path)
    action = obj.data.shape_keys.animation_data.action
    assert clear_from(obj) == []
    assert list(curves_of(action)) == []


def test_hidden_files_beside_meshes_are_no_meshes(blender, tmp_path):
    for name in ("figure.off", "._figure.off"):
        shapes.write_off(tmp_path / name, *shapes.figure(12))
    (tmp_path / "._figure.off").write_bytes(b"\0\5\26\7")
    code, lines = run(tmp_path, "--output", tmp_path / "out", "--reference", "first")
    assert (code, [Path(line["input"]).name for line in lines]) == (0, ["figure.off"])


@pytest.mark.skipif(os.name != "posix", reason="closed pipes are another error there")
def test_a_reader_that_ends_ends_the_run_quietly(tmp_path):
    for name in "ab":
        shapes.write_off(tmp_path / f"{name}.off", *shapes.figure(12))
    words = [sys.executable, "-m", "addon", "compute", str(tmp_path), "--output", str(tmp_path / "out")]
    root = Path(__file__).parents[2]
    with subprocess.Popen(words, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        told = process.stderr.read()
    assert process.returncode == 141
    assert "Traceback" not in told
    assert "Error" not in told


@pytest.fixture
def eyed(character):
    """The character with a second eye, which shares the mesh of the first."""
    second = bpy.data.objects.new("eye2", character["eye"].data)
    bpy.context.scene.collection.objects.link(second)
    second.location = (0.3, 5.0, 0.0)
    return [*character.values(), second]


def test_parts_that_share_a_mesh_each_have_a_form(eyed, tmp_path):
    path, names = saved(tmp_path), sorted(obj.name for obj in eyed)
    sizes = [len(obj.data.vertices) for obj in sorted(eyed, key=lambda each: each.name)]
    code, [line] = run(path, "--output", tmp_path / "out", "--together", "--format", "glb")
    assert code == 0, line
    assert sorted(obj.name for obj in open_meshes(Path(line["output"]))) == names  # the names of the objects, too
    assert line["objects"] == names
    assert line["vertices"] == sum(sizes)  # of the body, not of its first object
    assert sum(line["patch_sizes"]) <= sum(sizes)
    assert all(0 <= point < sum(sizes) for point in line["feature_points"])
    code, [line] = run(path, "--output", tmp_path / "shown", "--together", "--mesh", "shown")
    assert code == 0, line
    code, [line] = run(path, "--output", tmp_path / "blend", "--together")
    assert code == 0, line
    assert any("share their mesh" in each and "eye" in each for each in line["warnings"])


def test_a_reference_and_a_body_may_be_saved_in_edit_mode(character, tmp_path):
    bpy.ops.object.mode_set(mode="EDIT")
    path = saved(tmp_path)
    shapes.write_off(tmp_path / "scan.off", *shapes.figure(13))
    for words in ((path, "--together"), (tmp_path / "scan.off", "--reference", path)):
        code, lines = run(*words, "--output", tmp_path / "out")
        assert code == 0, lines


def test_frames_of_a_body_can_be_computed_again_and_cleared(character, tmp_path):
    trunk = character["trunk"]
    for frame, place in ((1, 0.0), (7, 0.5)):
        trunk.location.x = place
        trunk.keyframe_insert("location", frame=frame)
    words = ("--together", "--frames-as", "keys", "--frames")
    code, lines = run(saved(tmp_path), *words, "1:7:2", "--output", tmp_path / "first")
    assert code == 0, lines
    code, lines = run(lines[0]["output"], *words, "1:7:3", "--output", tmp_path / "second")
    assert code == 0, lines
    bpy.ops.wm.open_mainfile(filepath=lines[0]["output"])
    keys = bpy.data.objects["trunk"].data.shape_keys.key_blocks
    bpy.context.scene.frame_set(3)  # between 1 and 4
    values = [keys[f"Canonical Form {frame}"].value for frame in (1, 4)]
    assert sum(values) == pytest.approx(1.0, abs=1e-3)
    assert min(values) > 0.1
    bpy.context.view_layer.objects.active = bpy.data.objects["trunk"]
    with pytest.raises(RuntimeError, match="a form for each frame"):
        bpy.ops.object.canonical_form_limb(patch=0)
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert all(bpy.data.objects[name].data.shape_keys is None for name in character)


def library(folder):
    """A file with a figure in a collection."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    obj = add_object("Hero", *shapes.figure(13))
    collection = bpy.data.collections.new("Heroes")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    path = folder / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def linked(folder):
    path = library(folder)
    with bpy.data.libraries.load(str(path), link=True) as (_, found):
        found.objects = ["Hero"]
    bpy.context.scene.collection.objects.link(bpy.data.objects["Hero"])


def linked_collection(folder):
    path = library(folder)
    with bpy.data.libraries.load(str(path), link=True) as (_, found):
        found.collections = ["Heroes"]
    bpy.context.scene.collection.children.link(bpy.data.collections["Heroes"])


def overridden(folder):
    linked(folder)
    bpy.data.objects["Hero"].override_create(remap_local_usages=True).location.x = 5.0


def instanced(folder):
    path = library(folder)
    with bpy.data.libraries.load(str(path), link=True) as (_, found):
        found.collections = ["Heroes"]
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", bpy.data.collections["Heroes"]
    empty.location.x = 5.0
    bpy.context.scene.collection.objects.link(empty)


@pytest.mark.parametrize("how", [linked, linked_collection, overridden, instanced])
def test_what_another_file_holds_is_computed_where_nothing_is_written_into_it(how, tmp_path):
    how(tmp_path)
    path = saved(tmp_path)
    code, [line] = run(path, "--output", tmp_path / "out", "--format", "glb")
    assert code == 0, line
    assert line["object"] == "Hero"
    (obj,) = open_meshes(Path(line["output"]))
    assert in_scene(obj)[:, 0].mean() == pytest.approx(5.0 if how in (overridden, instanced) else 0.0, abs=1.0)
    code, [line] = run(path, "--output", tmp_path / "blend")
    assert code == 1
    assert "linked from another file" in line["error"] or "collection instances" in line["error"]
