"""Matches and transferred poses, between poses with other triangles: ``two_meshes.py FOLDER…`` or ``FOLDER:OTHER``.

A folder contains poses of one mesh as .obj, of which the first five are used; the meshes of two folders have the same
vertices. Every pose is matched with every other, reduced to 70 % by Blender's Decimate modifier and with its vertices
shuffled.

*Error* is the geodesic distance of a match from the truth, in 1/100 sqrt(area), at 300 vertices; *near* the share below
.05; *flips* the pairs with a tenth of the vertices beyond .3; *pose* the distance of a transferred pose from the true
pose, relative to the distance between the two poses, for those more than .1 apart; *edges* the median change of edge
lengths; *crossed* the pairs after which more triangles cross than in either of the two poses.
"""

import sys
from itertools import product
from pathlib import Path
from time import perf_counter

import bpy
import numpy as np
import potpourri3d

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import pose_like, transferred  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.measures.crossings import crossings  # noqa: E402
from addon.core.mesh.closest_points import closest_points  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from tests.meshes.shapes import permuted, poses_of  # noqa: E402

POSES, SAMPLES = 5, 300
LEFT = 0.7  # share of the triangles


def main(names: list[str]) -> None:
    print("| meshes | pairs | error | most | near | flips | pose | most | edges | crossed | seconds |")
    print("| --- " * 11 + "|")
    for name in names:
        print(row(*(Path(part) for part in (name.split(":") * 2)[:2])), flush=True)


def row(folder: Path, other: Path) -> str:
    here, there = poses_of(folder)[:POSES], poses_of(other)[:POSES]
    reduced = [reduced_mesh(vertices, faces) for _, vertices, faces in there]
    before = [len(crossings(vertices, faces)) for _, vertices, faces in here]
    errors, ratios, edges, seconds, crossed = [], [], [], [], 0
    for i, j in product(range(len(here)), range(len(there))):
        if i == j:
            continue
        (_, vertices, faces), (_, whole, whole_faces) = here[i], there[j]
        began = perf_counter()
        found = pose_like(vertices, faces, *reduced[j])
        seconds.append(perf_counter() - began)
        errors.append(geodesic_errors(transferred(found.match, reduced[j][0]), whole, whole_faces))
        apart = distance(vertices, here[j][1])
        if apart > 0.1 * np.sqrt(surface_area(vertices, faces)):
            ratios.append(distance(found.vertices, here[j][1]) / apart)
        edges.append(found.edge_distortion)
        crossed += len(crossings(found.vertices, faces)) > max(before[i], before[j])
    means = [each.mean() for each in errors]
    flips = sum(np.mean(each > 0.3) > 0.1 for each in errors)
    label = folder.name if folder == other else f"{folder.name} onto {other.name}"
    return (
        f"| {label} | {len(errors)} | {100 * np.mean(means):.2f} | {100 * max(means):.2f} |"
        f" {np.mean(np.array(errors) < 0.05):.0%} | {flips} | {np.mean(ratios or [np.nan]):.3f} |"
        f" {max(ratios or [np.nan]):.3f} | {np.median(edges):.3f} | {crossed} | {np.median(seconds):.1f} |"
    )


def reduced_mesh(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Reduce a mesh with Blender, and shuffle its vertices."""
    data = bpy.data.meshes.new("mesh")
    data.from_pydata(vertices.tolist(), [], faces.tolist())
    item = bpy.data.objects.new("mesh", data)
    bpy.context.scene.collection.objects.link(item)
    modifier = item.modifiers.new("Decimate", "DECIMATE")
    modifier.ratio, modifier.use_collapse_triangulate = LEFT, True
    made = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    made.calc_loop_triangles()
    points = np.array([vertex.co[:] for vertex in made.vertices])
    corners = np.array([triangle.vertices[:] for triangle in made.loop_triangles])
    bpy.data.objects.remove(item)
    points, corners, _ = permuted(points, corners)
    return points, corners


def geodesic_errors(places: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Measure how far points on a mesh are from the vertices with the same indices, in sqrt(area)."""
    samples = np.random.default_rng(1).choice(len(vertices), min(SAMPLES, len(vertices)), replace=False)
    solver = potpourri3d.MeshHeatMethodDistanceSolver(vertices, faces)
    found = closest_points(vertices, faces, places[samples])
    far = np.array([solver.compute_distance(int(sample)) for sample in samples])
    at = np.take_along_axis(far, faces[found.faces], axis=1)
    return np.einsum("ij,ij->i", found.weights, at) / np.sqrt(surface_area(vertices, faces))


def distance(one: np.ndarray, two: np.ndarray) -> float:
    """Return the root mean square distance of vertices after a rigid fit."""
    rotation, shift = rigid_fit(one, two)
    return float(np.sqrt(((one @ rotation + shift - two) ** 2).sum(axis=1).mean()))


if __name__ == "__main__":
    main(sys.argv[1:])
