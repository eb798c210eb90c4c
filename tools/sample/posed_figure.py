"""Builds the sample figure in Blender: a stick figure, skinned, subdivided, and posed by an armature."""

import math

import bpy

# joints of the figure in the rest pose: position and radius of the skin
JOINTS = {
    "pelvis": ((0.00, 0.00, 1.00), 0.165),
    "spine": ((0.00, 0.01, 1.22), 0.150),
    "chest": ((0.00, 0.00, 1.45), 0.185),
    "neck": ((0.00, 0.00, 1.63), 0.070),
    "head": ((0.00, -0.02, 1.80), 0.125),
    "crown": ((0.00, -0.02, 1.93), 0.080),
    "shoulder": ((0.21, 0.00, 1.54), 0.080),
    "elbow": ((0.48, 0.01, 1.47), 0.058),
    "wrist": ((0.73, -0.01, 1.42), 0.042),
    "hand": ((0.86, -0.02, 1.40), 0.048),
    "fingers": ((0.95, -0.02, 1.38), 0.028),
    "hip": ((0.11, 0.00, 0.91), 0.125),
    "knee": ((0.14, -0.02, 0.50), 0.080),
    "ankle": ((0.15, 0.02, 0.10), 0.055),
    "foot": ((0.16, -0.10, 0.05), 0.052),
    "toes": ((0.17, -0.20, 0.04), 0.035),
}
BONES = [
    ("pelvis", "spine"), ("spine", "chest"), ("chest", "neck"), ("neck", "head"), ("head", "crown"),
    ("chest", "shoulder"), ("shoulder", "elbow"), ("elbow", "wrist"), ("wrist", "hand"), ("hand", "fingers"),
    ("pelvis", "hip"), ("hip", "knee"), ("knee", "ankle"), ("ankle", "foot"), ("foot", "toes"),
]  # fmt: skip
PAIRED = {"shoulder", "elbow", "wrist", "hand", "fingers", "hip", "knee", "ankle", "foot", "toes"}
POSE = {  # degrees about the world axes x, y, z, by the joint at which the bone starts
    "elbow.L": ("wrist.L", (0, 0, -75)), "shoulder.L": ("elbow.L", (20, 65, -20)),
    "elbow.R": ("wrist.R", (-95, 0, 0)), "shoulder.R": ("elbow.R", (-55, -10, 40)),
    "hip.L": ("knee.L", (-60, -10, 0)), "knee.L": ("ankle.L", (75, 0, 0)),
    "hip.R": ("knee.R", (30, 12, 0)), "knee.R": ("ankle.R", (35, 0, 0)),
    "pelvis": ("spine", (12, 0, 0)), "spine": ("chest", (10, 0, 25)), "neck": ("head", (-15, 0, 25)),
}  # fmt: skip


def joints():
    """Return all joints, the paired ones on both sides."""
    placed = {}
    for name, ((x, y, z), radius) in JOINTS.items():
        if name in PAIRED:
            placed[f"{name}.L"], placed[f"{name}.R"] = ((x, y, z), radius), ((-x, y, z), radius)
        else:
            placed[name] = ((x, y, z), radius)
    return placed


def bones():
    """Return all bones as pairs of joints, the paired ones on both sides."""
    for tail, head in BONES:
        if head in PAIRED:
            for side in (".L", ".R"):
                yield tail + side if tail in PAIRED else tail, head + side
        else:
            yield tail, head


def build(name="Figure", levels=2, posed=True):
    """Build the figure in the current scene, apply its modifiers, and return its object."""
    body = skin(name, levels)
    if posed:
        armature = rig(body)
        pose(armature)
        apply_modifiers(body)
        bpy.data.objects.remove(armature)
        body.parent = None
        body.vertex_groups.clear()
    for polygon in body.data.polygons:
        polygon.use_smooth = True
    return body


def skin(name, levels):
    """Create a closed skin of quads around the sticks."""
    placed = joints()
    order = list(placed)
    mesh = bpy.data.meshes.new(name)
    edges = [(order.index(tail), order.index(head)) for tail, head in bones()]
    mesh.from_pydata([place for place, _ in placed.values()], edges, [])
    body = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(body)
    activate(body)
    body.modifiers.new("Skin", "SKIN").use_smooth_shade = True
    for vertex, (_, radius) in zip(mesh.skin_vertices[0].data, placed.values(), strict=True):
        vertex.radius = (radius, radius)
    mesh.skin_vertices[0].data[order.index("pelvis")].use_root = True
    body.modifiers.new("Subdivision", "SUBSURF").levels = levels
    apply_modifiers(body)
    return body


def rig(body):
    """Add an armature to the body and parent the body to it with automatic weights."""
    placed = joints()
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(armature)
    activate(armature)
    bpy.ops.object.mode_set(mode="EDIT")
    made: dict[str, bpy.types.EditBone] = {}
    for tail, head in bones():
        bone = armature.data.edit_bones.new(head)
        bone.head, bone.tail = placed[tail][0], placed[head][0]
        bone.parent = made.get(tail)
        made[head] = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    activate(body)
    armature.select_set(True)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    return armature


def pose(armature):
    """Rotate the bones, each about the world axes at its own joint, from the trunk outwards."""
    from mathutils import Euler, Matrix

    for bone in armature.pose.bones:  # parents come before their children
        turns = [turn for target, turn in POSE.values() if target == bone.name]
        if not turns:
            continue
        bpy.context.view_layer.update()
        turn = Euler([math.radians(angle) for angle in turns[0]]).to_matrix().to_4x4()
        place = Matrix.Translation(bone.matrix.translation)
        bone.matrix = place @ turn @ place.inverted() @ bone.matrix
    bpy.context.view_layer.update()


def apply_modifiers(body):
    """Apply all modifiers of an object."""
    activate(body)
    for modifier in list(body.modifiers):
        bpy.ops.object.modifier_apply(modifier=modifier.name)


def activate(obj):
    """Select only this object and make it active."""
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
