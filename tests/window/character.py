"""A rigged character for the session in a window."""

import bpy


def add_character(files):
    """Add the character of a file, or one made of pieces, in place of all objects; the armature that moves it."""
    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    if files:
        bpy.ops.import_scene.gltf(filepath=str(files[0]), merge_vertices=True)
        bpy.data.batch_remove([obj for obj in bpy.data.objects if obj.name.startswith("Icosphere")])
        return next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    from tests.meshes.pieced import character as made

    pieces = made()[2]
    mesh = bpy.data.meshes.new("Character")
    mesh.from_pydata(pieces.vertices.tolist(), [], pieces.faces.tolist())
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    obj = bpy.data.objects.new("Character", mesh)
    for each in (rig, obj):
        bpy.context.scene.collection.objects.link(each)
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    return rig
