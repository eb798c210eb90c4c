"""Objects that Blender does not evaluate, as in an excluded collection, stand where the file says. And deleted ones."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from addon.blender.objects.mesh_reading import read_object
from addon.blender.objects.placement import placement_of
from addon.interface.viewport import any_result

from .conftest import QUICK, add_object

PLACE = Matrix.LocRotScale((5.0, 0.0, 1.0), Euler((1.5, 0.0, 0.7)), (2.0, 2.0, 2.0))


def excluded(obj):
    collection = bpy.data.collections.new("Put away")
    bpy.context.scene.collection.children.link(collection)
    moved_to(obj, collection)
    bpy.context.view_layer.layer_collection.children["Put away"].exclude = True


def moved_to(obj, collection):
    bpy.context.scene.collection.objects.unlink(obj)
    collection.objects.link(obj)


def off_in_views(obj):
    obj.hide_viewport = True


def in_another_scene(obj):
    moved_to(obj, bpy.data.scenes.new("Other").collection)


@pytest.mark.parametrize("put_away", [excluded, off_in_views, in_another_scene])
@pytest.mark.parametrize("parented", [False, True])
def test_an_object_of_an_opened_file_stands_where_it_was_left(blender, arrays, tmp_path, put_away, parented):
    obj = add_object("Base", *arrays)
    obj.matrix_basis = PLACE
    if parented:
        obj.parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(obj.parent)
        obj.parent.location = (0.0, 7.0, 0.0)
    bpy.context.view_layer.update()
    there = np.array(obj.matrix_world)
    assert there[0, 3] == 5.0
    put_away(obj)
    path = tmp_path / "put_away.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj, scenes = bpy.data.objects["Base"], len(bpy.data.scenes)
    hidden = obj.hide_viewport
    np.testing.assert_allclose(placement_of(obj, False), there, atol=1e-5)
    np.testing.assert_allclose(read_object(obj).placement, there, atol=1e-5)
    np.testing.assert_allclose(np.array(obj.matrix_world), there, atol=1e-5)  # for all that read it later
    assert len(bpy.data.scenes) == scenes
    assert obj.hide_viewport == hidden


def test_what_is_switched_off_is_not_computed_to_place_it(blender, arrays, tmp_path):
    obj = add_object("Heavy", *arrays)
    obj.location.x = 5.0
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    obj.hide_viewport = True
    path = tmp_path / "heavy.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects["Heavy"]
    seen: list[str] = []
    bpy.app.handlers.depsgraph_update_post.append(lambda _, graph: seen.extend(each.name for each in graph.objects))
    assert placement_of(obj, False)[0, 3] == 5.0
    bpy.app.handlers.depsgraph_update_post.pop()
    assert "Heavy" not in seen
    assert len(bpy.data.objects) == 1


def test_a_linked_object_that_is_put_away_stands_where_its_file_says(blender, arrays, tmp_path):
    add_object("Base", *arrays).location.x = 5.0
    library = tmp_path / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Base"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    excluded(wanted.objects[0])
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert placement_of(bpy.data.objects["Base"], False)[0, 3] == 5.0


def test_an_animated_object_stands_where_the_frame_says(blender, arrays, tmp_path):
    obj = add_object("Base", *arrays)
    for frame, place in ((1, 0.0), (11, 10.0)):
        obj.location.x = place
        obj.keyframe_insert("location", frame=frame)
    excluded(obj)
    bpy.context.scene.frame_set(11)
    path = tmp_path / "animated.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert placement_of(bpy.data.objects["Base"], False)[0, 3] == pytest.approx(10.0)


def test_a_deleted_object_is_no_result(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    assert any_result()
    bpy.data.objects.remove(figure_object)
    assert not any_result()
