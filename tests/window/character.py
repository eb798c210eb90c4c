"""Rigged characters in the session in a window: of one object, and of several."""

import bpy


def character(hand, files, compute):
    """Compute on the mesh of the active armature, look, and clear."""
    add_character(files)
    yield from shown(hand)
    before = states()
    yield from compute()
    lines = [len(obj.data.canonical_form_patches) for obj in meshes()]
    print("  patches of the character:", lines, flush=True)
    assert max(lines) <= 10, "the pieces are not one body"
    yield from framed(hand)
    yield from hand.picture("12-character")
    bpy.ops.object.canonical_form_clear()
    yield 0.5
    assert states() == before, "clear does not leave the character as it was"


def several_objects(hand, files, compute):
    """One click, one slider, one undo and one Clear for all objects of a character."""
    add_character(files)
    bpy.context.view_layer.update()
    if len(meshes()) == 1:
        separate(meshes()[0])
    yield from shown(hand)
    before = states()
    print("  objects:", len(before), flush=True)
    yield from compute()
    after = states()
    assert all(after[name] != before[name] for name in before), "an object was left out"
    yield from framed(hand)
    yield from hand.picture("13-objects")
    below, _ = yield from hand.find('key_blocks["Canonical Form"].value')
    x, y = hand.below_top(below, 0.9)
    yield from hand.drag(x, y, x - 110, y)
    yield 0.5
    values = [round(obj.data.shape_keys.key_blocks["Canonical Form"].value, 4) for obj in meshes()]
    yield from hand.picture("14-objects-slider")
    assert len(set(values)) == 1, f"the slider does not move all: {values}"
    assert 0.02 < values[0] < 0.98, f"the slider was not dragged: {values[0]}"
    yield from hand.over_view()
    for _ in range(2):
        yield from hand.key("Z", ctrl=True)
        yield 0.7
    assert states() == before, "undo does not bring all objects back"
    yield from hand.key("Z", ctrl=True, shift=True)
    yield 0.7
    assert states() == after, "redo does not bring the forms back"
    bpy.ops.object.canonical_form_clear()
    yield 0.5
    assert states() == before, "clear does not leave the objects as they were"
    yield from hand.picture("15-objects-cleared")


def add_character(files):
    """Add the character of a file, or one made of pieces, in place of all objects; its armature is active."""
    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    if files:
        bpy.ops.import_scene.gltf(filepath=str(files[0]), merge_vertices=True)
        bpy.data.batch_remove([obj for obj in bpy.data.objects if obj.name.startswith("Icosphere")])
    else:
        from tests.meshes.pieced import character as made

        pieces = made()[2]
        mesh = bpy.data.meshes.new("Character")
        mesh.from_pydata(pieces.vertices.tolist(), [], pieces.faces.tolist())
        rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
        obj = bpy.data.objects.new("Character", mesh)
        for each in (rig, obj):
            bpy.context.scene.collection.objects.link(each)
        obj.modifiers.new("Armature", "ARMATURE").object = rig
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.type == "ARMATURE")
        if obj.type == "ARMATURE":
            bpy.context.view_layer.objects.active = obj


def separate(obj):
    """Make an object of every piece, in a place of its own."""
    armature = bpy.context.view_layer.objects.active
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.separate(type="LOOSE")
    bpy.ops.object.mode_set(mode="OBJECT")
    for number, each in enumerate(meshes()):
        each.data.transform(each.matrix_world)
        each.location = (number, -number, 0.5 * number)
        bpy.context.view_layer.update()
        each.data.transform(each.matrix_world.inverted())
        each.select_set(False)
    bpy.context.view_layer.objects.active = armature


def meshes():
    return [obj for obj in bpy.data.objects if obj.type == "MESH"]


def states():
    """Everything of the meshes that a run may touch, by object."""
    return {obj.name: state(obj) for obj in meshes()}


def state(obj):
    """Everything of a mesh that a run may touch; addresses change with undo, so values only."""
    mesh = obj.data
    keys = mesh.shape_keys
    return {
        "vertices": [tuple(vertex.co) for vertex in mesh.vertices],
        "keys": keys and {key.name: (key.value, [tuple(point.co) for point in key.data]) for key in keys.key_blocks},
        "groups": [group.name for group in obj.vertex_groups],
        "colours": [colours.name for colours in mesh.color_attributes],
        "attributes": sorted(each.name for each in mesh.attributes),
        "properties": sorted(mesh.keys()),
        "mode": obj.mode,
    }


def shown(hand):
    """Frame all and push an undo step."""
    yield from framed(hand)
    bpy.ops.ed.undo_push(message="Character")
    yield 1.0


def framed(hand):
    """Frame all in the view."""
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.view3d.view_all()
    yield 0.5
