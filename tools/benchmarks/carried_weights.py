"""Weights of a rigged character, transferred to a reduced mesh in another pose, and posed again by the rig.

``python tools/benchmarks/carried_weights.py CHARACTER.glb…`` prints one row per character. The source is the rest pose
with its weights; the target is another pose, reduced by Blender's Decimate modifier, with shuffled vertices. The true
weights are those of the nearest point of the whole mesh in that pose. Needs bpy.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[2])]

from addon.core import match, transferred  # noqa: E402
from addon.core.mesh.closest_points import closest_points  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from tools.benchmarks.characters import posed, turned_at_random  # noqa: E402
from tools.benchmarks.two_meshes import reduced_mesh  # noqa: E402


def main(files: list[Path]) -> None:
    print("| character | bones | weights: mean difference | half sum a vertex | posed: RMS (most) | poses apart |")
    print("| --- | --- | --- | --- | --- | --- |")
    for file in files:
        print(row(file), flush=True)


def row(file: Path) -> str:
    poses, faces = posed(file)
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    bones = [bone.name for bone in rig.data.bones if bone.use_deform]
    weights = weights_of(rig, bones)
    turns = [motions(rig, bones) for _ in turned_at_random(rig, len(poses))]
    root = np.sqrt(surface_area(poses[0], faces))
    entries, sums, moved, apart = [], [], [], []
    for number in range(1, len(poses)):
        other = number % (len(poses) - 1) + 1
        vertices, own = reduced_mesh(poses[number], faces)
        got = transferred(match(vertices, own, poses[0], faces), weights)
        nearest = closest_points(poses[number], faces, vertices)
        true = np.einsum("ij,ijb->ib", nearest.weights, weights[faces[nearest.faces]])
        way = turns[other] @ np.linalg.inv(turns[number])
        ends = [blended(each, vertices, way) for each in (got, true)]
        entries.append(np.abs(got - true).mean())
        sums.append(np.abs(got - true).sum(axis=1).mean() / 2)
        moved.append(rms(ends[0] - ends[1]) / root)
        apart.append(rms(poses[number] - poses[other]) / root)
    return (
        f"| {file.stem} | {len(bones)} | {np.mean(entries):.4f} | {np.mean(sums):.2f} |"
        f" {np.mean(moved):.4f} ({max(moved):.4f}) | {np.mean(apart):.2f} |"
    )


def weights_of(rig: bpy.types.Object, bones: list[str]) -> np.ndarray:
    """Read the weights of all objects of a rig, in the order of `posed`; (n, bones), rows sum to 1."""
    objects = (obj for obj in bpy.data.objects if obj.parent is rig and obj.type == "MESH")
    parts = []
    for obj in sorted(objects, key=lambda o: o.name):
        column = {group.index: bones.index(group.name) for group in obj.vertex_groups if group.name in bones}
        own = np.zeros((len(obj.data.vertices), len(bones)))
        for vertex in obj.data.vertices:
            for part in vertex.groups:
                if part.group in column:
                    own[vertex.index, column[part.group]] += part.weight
        parts.append(own)
    weights = np.concatenate(parts)
    return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-9)


def motions(rig: bpy.types.Object, bones: list[str]) -> np.ndarray:
    """Return how each bone moves the mesh from its rest pose, (bones, 4, 4)."""
    world = np.array(rig.matrix_world)
    rest = np.array([np.array(rig.data.bones[name].matrix_local) for name in bones])
    now = np.array([np.array(rig.pose.bones[name].matrix) for name in bones])
    return world @ now @ np.linalg.inv(rest) @ np.linalg.inv(world)


def blended(weights: np.ndarray, vertices: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """Apply linear blend skinning."""
    homogeneous = np.column_stack([vertices, np.ones(len(vertices))])
    return np.einsum("nb,bij,nj->ni", weights, motion, homogeneous)[:, :3]


def rms(way: np.ndarray) -> float:
    return float(np.sqrt((way**2).sum(axis=1).mean()))


if __name__ == "__main__":
    main([Path(word) for word in sys.argv[1:]])
