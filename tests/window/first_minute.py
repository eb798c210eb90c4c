"""What artists meet in their first minutes, in the session in a window; each with a picture."""

import importlib

import bmesh
import bpy
import numpy as np

from tests.meshes import shapes
from tests.window.character import shown

NAME = "Canonical Form"


def first_minute(hand, compute):
    """Show painted meshes, frames, renamed keys, new objects, mirrors, seams and warnings, one after the other."""
    steps = (painted, as_shown, renamed_key, new_object, mirrored, finer_over_seams, warnings)
    for number, each in enumerate(steps, 20):
        bpy.data.batch_remove([*bpy.data.objects])
        yield from each(hand, compute, f"{number}-{each.__name__}")


def report():
    """The report of the active object's run."""
    records = importlib.import_module("bl_ext.user_default.canonical_form.addon.blender.records.record")
    return records.require_record(bpy.context.object.data).report


def painted(hand, compute, name):
    """The patches of a painted mesh are visible; Clear brings the choice of colours back."""
    colours = add("Painted", *shapes.figure(16)).data.color_attributes
    colours.new("Paint", "BYTE_COLOR", "CORNER")
    colours.new("Rust", "FLOAT_COLOR", "POINT")
    colours.active_color_name = "Rust"
    yield from shown(hand)
    yield from compute()
    colours = bpy.context.object.data.color_attributes
    active = colours.active_color_name
    yield from hand.picture(name)
    assert active not in ("Paint", "Rust"), "the patches are not shown"
    bpy.ops.object.canonical_form_clear()
    yield 0.5
    colours = bpy.context.object.data.color_attributes
    assert (colours.active_color_name, len(colours)) == ("Rust", 2), "the choice of colours is not back"


def as_shown(hand, compute, name):
    """The form of what an armature shows says of which frame it is, and is offered again at another."""
    obj = add("Shown", *shapes.figure(16))
    rig(obj)
    bpy.context.scene.frame_set(3)
    yield from shown(hand)
    yield from compute()
    yield from hand.picture(name)
    bpy.context.scene.frame_set(9)
    yield from hand.picture(f"{name}-at-another-frame")
    assert report().frame == 3
    bpy.context.scene.frame_set(1)


def renamed_key(hand, compute, name):
    """A renamed in-between is told in a line, and the others can be removed anyway."""
    add("Renamed", *shapes.figure(16))
    yield from shown(hand)
    yield from compute()
    bpy.ops.object.canonical_form_in_betweens(count=2)
    keys = bpy.context.object.data.shape_keys.key_blocks
    keys[f"{NAME} 33%"].name = "Mine"
    yield from hand.picture(name)
    assert bpy.ops.object.canonical_form_remove_in_betweens() == {"FINISHED"}
    assert {key.name for key in bpy.context.object.data.shape_keys.key_blocks} == {"Basis", NAME, "Mine"}


def new_object(hand, compute, name):
    """A new object becomes active and shows its result."""
    add("Original", *shapes.figure(16))
    bpy.context.object.canonical_form.result = "OBJECT"
    yield from shown(hand)
    yield from compute()
    yield from hand.picture(name)
    assert bpy.context.object.name == f"Original {NAME}", f"{bpy.context.object.name} is active"
    assert bpy.context.object.select_get()


def mirrored(hand, compute, name):
    """The border of a mirrored half stays on the mirror."""
    obj = add("Half", *shapes.figure(16))
    half = bmesh.new()
    half.from_mesh(obj.data)
    every = [*half.verts, *half.edges, *half.faces]
    bmesh.ops.bisect_plane(half, geom=every, plane_co=(0, 0, 0), plane_no=(1, 0, 0), clear_inner=True)
    half.to_mesh(obj.data)
    half.free()
    obj.modifiers.new("Mirror", "MIRROR")
    yield from shown(hand)
    yield from compute()
    yield from hand.picture(name)
    keys = bpy.context.object.data.shape_keys.key_blocks
    on_mirror = [number for number, point in enumerate(keys["Basis"].data) if point.co.x == 0]
    assert on_mirror
    assert all(keys[NAME].data[number].co.x == 0 for number in on_mirror), "the border has left the mirror"


def finer_over_seams(hand, compute, name):
    """A body cut along seams, as a .glb stores it, remains one body under a Subdivision modifier."""
    seamed = shapes.cut_along_seams(*shapes.figure(16))
    add("Seamed", *seamed).modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.context.object.canonical_form.mesh = "SHOWN"
    yield from shown(hand)
    yield from compute()
    yield from hand.picture(name)
    assert len(bpy.context.object.data.canonical_form_patches) <= 8, "seams have opened"


def warnings(hand, compute, name):
    """Many warnings are folded under their number."""
    vertices, faces = shapes.figure(16)
    faces = np.concatenate([faces, faces[:1, ::-1], faces[9:10]])
    faces[50] = faces[50, ::-1]
    obj = add("Damaged", np.concatenate([vertices, vertices[:1] + 3]), faces)
    obj.modifiers.new("Thicker", "SOLIDIFY")
    yield from shown(hand)
    yield from compute()
    yield from hand.picture(name)
    assert len(report().warnings) == 5, report().warnings  # the first about its limbs


def add(name, vertices, faces):
    """Add a mesh and make it the active object."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.view_layer.update()  # the window may have none yet
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def rig(obj):
    """Move a mesh by an armature whose upper bone turns with the frames."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    heights = [vertex.co.z for vertex in obj.data.vertices]
    middle = (min(heights) + max(heights)) / 2
    for name, low, high in (("Low", min(heights), middle), ("High", middle, max(heights))):
        bone = armature.data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, low), (0, 0, high)
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, above in (("Low", False), ("High", True)):
        chosen = [number for number, height in enumerate(heights) if (height > middle) == above]
        obj.vertex_groups.new(name=name).add(chosen, 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = armature
    bone = armature.pose.bones["High"]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (10, 0.7)):
        bone.rotation_euler.x = angle
        bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.view_layer.objects.active = obj
