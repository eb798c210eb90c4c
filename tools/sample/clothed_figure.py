"""Dresses the sample figure: head, hands, shirt, trousers, shoes, hat and eyes as objects of one armature."""

import bmesh
import bpy

from tools.sample.posed_figure import activate, pose, rig, skin

SKIN, SHIRT, TROUSERS, SHOES, HAT, EYES = (
    (0.80, 0.55, 0.42, 1), (0.20, 0.36, 0.60, 1), (0.25, 0.24, 0.28, 1), (0.30, 0.14, 0.08, 1),
    (0.62, 0.16, 0.14, 1), (0.95, 0.95, 0.95, 1),
)  # fmt: skip


def build(levels=3, posed=True):
    """Build the character in the current scene and return its armature."""
    body = skin("Body", levels)
    armature = rig(body)
    for name, colour, thickness, wanted in (
        ("Shirt", SHIRT, 0.022, lambda x, y, z: abs(x) < 0.62 and (z > 0.98 or abs(x) > 0.25) and z < 1.60),
        ("Trousers", TROUSERS, 0.012, lambda x, y, z: abs(x) < 0.32 and 0.12 < z < 1.06),
        ("Shoes", SHOES, 0.020, lambda x, y, z: z < 0.16),
        ("Hat", HAT, 0.020, lambda x, y, z: z > 1.88),
    ):
        shell(body, name, colour, thickness, wanted)
    for side in (-1, 1):
        eye(body, f"Eye.{'L' if side > 0 else 'R'}", (0.055 * side, -0.135, 1.83))
    keep(body, lambda x, y, z: abs(x) > 0.56 or (z > 1.56 and abs(x) < 0.16) or z < 0.18)
    paint(body, SKIN)
    if posed:
        pose(armature)
    activate(armature)
    return armature


def shell(body, name, colour, thickness, wanted):
    """Add a piece of clothing: a part of the skin, moved outwards."""
    copy = body.copy()
    copy.data, copy.name = body.data.copy(), name
    bpy.context.scene.collection.objects.link(copy)
    normals = [vertex.normal.copy() for vertex in copy.data.vertices]
    for vertex, normal in zip(copy.data.vertices, normals, strict=True):
        vertex.co += thickness * normal
    keep(copy, wanted)
    paint(copy, colour)


def eye(body, name, place):
    """Add an eye that follows the head."""
    mesh = bpy.data.meshes.new(name)
    ball = bmesh.new()
    bmesh.ops.create_uvsphere(ball, u_segments=16, v_segments=10, radius=0.022)
    ball.to_mesh(mesh)
    ball.free()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = place
    obj.vertex_groups.new(name="head").add(range(len(mesh.vertices)), 1.0, "REPLACE")
    for modifier in body.modifiers:
        if modifier.type == "ARMATURE":
            obj.modifiers.new(modifier.name, "ARMATURE").object = modifier.object
            obj.parent = modifier.object
    paint(obj, EYES)


def keep(obj, wanted):
    """Keep only the faces whose centres are wanted."""
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    spare = [face for face in mesh.faces if not wanted(*face.calc_center_median())]
    bmesh.ops.delete(mesh, geom=spare, context="FACES")
    mesh.to_mesh(obj.data)
    mesh.free()
    obj.data.update()


def paint(obj, colour):
    """Set the colour of an object, in the viewport and as a material."""
    material = bpy.data.materials.new(obj.name)
    material.diffuse_color = colour
    obj.color = colour
    obj.data.materials.clear()
    obj.data.materials.append(material)
    for polygon in obj.data.polygons:
        polygon.use_smooth = True
