"""Blender's automatic weights, to compare with."""

from __future__ import annotations

import numpy as np

from ...core import Skeleton
from ...core.numerics.arrays import FloatArray, IntArray
from ..reading import load_blender

_SHORTEST = 1e-3  # of the skeleton: shorter bones are lengthened, as Blender removes them


def automatic_weights(vertices: FloatArray, faces: IntArray, bones: Skeleton) -> FloatArray:
    """Weigh a mesh by Blender's *With Automatic Weights*, in this process.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles.
    bones : Skeleton
        The bones, as they lie in the mesh.

    Returns
    -------
    (n, b) ndarray of float
        Weights; 0 for a vertex that Blender gives none.

    References
    ----------
    Baran and Popović, "Automatic Rigging and Animation of 3D Characters", 2007, doi:10.1145/1276377.1276467.
    """
    load_blender()
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    body = bpy.data.objects.new("Body", mesh)
    data = bpy.data.armatures.new("Bones")
    armature = bpy.data.objects.new("Bones", data)
    for each in (body, armature):
        bpy.context.scene.collection.objects.link(each)
    layer = bpy.context.view_layer.objects
    layer.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    size = float(np.ptp(bones.heads, axis=0).max())
    made = [data.edit_bones.new(name) for name in bones.names]
    for number, bone in enumerate(made):
        way = bones.tails[number] - bones.heads[number]
        if np.linalg.norm(way) < _SHORTEST * size:
            way = np.array([0.0, 0.0, 2 * _SHORTEST * size])
        bone.head, bone.tail = bones.heads[number], bones.heads[number] + way
        if bones.parents[number] >= 0:
            bone.parent = made[bones.parents[number]]
    names = [bone.name for bone in made]
    bpy.ops.object.mode_set(mode="OBJECT")
    body.select_set(True)
    armature.select_set(True)
    layer.active = armature
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    own = {group.index: names.index(group.name) for group in body.vertex_groups}
    weights = np.zeros((len(vertices), len(names)))
    for vertex in mesh.vertices:
        for entry in vertex.groups:
            weights[vertex.index, own[entry.group]] = entry.weight
    return weights
