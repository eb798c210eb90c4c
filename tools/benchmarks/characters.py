"""Characters of many pieces in several poses: ``characters.py FILE.glb…`` (or ``.blend``), with random bone rotations.

For each pose: feature points, attachment (how much the distance of a vertex from the nearest point of another piece
changes, for those nearer than .02), edge distortion of the worst piece, seconds; for each character the pose ratio.
Files with animation are posed by their clips instead.
"""

import sys
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from time import perf_counter

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import Settings, canonical_form  # noqa: E402
from addon.core.assembly.contacts import sampled  # noqa: E402
from addon.core.assembly.pieces import Piece, connected_pieces  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.measures.form_measures import edge_stretch  # noqa: E402
from addon.core.mesh.geometry import surface_area, vertex_areas  # noqa: E402

ARMS, LEGS = ("arm", "front_leg_upper", "front_leg_lower"), ("thigh", "calf", "back_leg_upper", "back_leg_lower")
POSES = 6
NEAR = 0.02


def main(files: list[Path]) -> None:
    print("| character | pieces | features | attachment, 95 % | worst piece, 95 % | pose ratio | seconds |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for file in files:
        poses, faces = posed(file)
        results = [timed(pose, faces) for pose in poses]
        pieces = [connected_pieces(pose, faces).pieces for pose in poses]
        features = sorted({len(found.feature_points) for found, _ in results})
        each = list(zip(poses, pieces, (found for found, _ in results), strict=True))
        attached = [attachment(pose, own, found.vertices, faces) for pose, own, found in each]
        stretched = [max(distortion(piece, found.vertices) for piece in own) for _, own, found in each]
        ratio = spread([found.vertices for found, _ in results], faces) / spread(poses, faces)
        seconds = np.median([taken for _, taken in results])
        print(
            f"| {file.stem} | {len(pieces[0])} | {', '.join(map(str, features))} | {several(attached, 4)} |"
            f" {several(stretched, 2)} | {ratio:.2f} | {seconds:.1f} |",
            flush=True,
        )


def several(values: list[float], digits: int) -> str:
    return f"{np.median(values):.{digits}f} (most {max(values):.{digits}f})"


def posed(file: Path, count: int = POSES) -> tuple[list[np.ndarray], np.ndarray]:
    """Read a rigged character in its rest pose and other poses, with all objects as one mesh."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if file.suffix == ".blend":
        bpy.ops.wm.open_mainfile(filepath=str(file))
    else:
        bpy.ops.import_scene.gltf(filepath=str(file), merge_vertices=True)
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    objects = sorted(
        (obj for obj in bpy.data.objects if obj.parent is rig and obj.type == "MESH"), key=lambda o: o.name
    )
    poses = []
    for number in turned_at_random(rig, count):
        if bpy.data.actions:
            take_clip(rig, number)
        vertices, faces = evaluated(objects)
        poses.append(vertices)
    return poses, faces


def turned_at_random(rig: bpy.types.Object, count: int) -> Iterator[int]:
    """Rotate arms and legs of a rig at random with a fixed seed, if it has no clips; the first is the rest pose."""
    rng = np.random.default_rng(1)
    for number in range(count):
        for bone in rig.pose.bones if not bpy.data.actions else ():
            bone.rotation_mode, name = "XYZ", bone.name.lower()
            most = 45 if any(part in name for part in ARMS) else 35 if name.startswith(LEGS) else 0
            bone.rotation_euler = np.radians(rng.uniform(-most, most, 3)) * bool(number)
        bpy.context.view_layer.update()
        yield number


def take_clip(rig: bpy.types.Object, number: int) -> None:
    """Go to a frame of a clip: first the rest pose, then the middle of the clips in turn."""
    clips = sorted(bpy.data.actions, key=lambda action: (not action.name.startswith("Rest"), action.name))
    action = clips[number % len(clips)]
    for track in list(rig.animation_data.nla_tracks):
        rig.animation_data.nla_tracks.remove(track)
    rig.animation_data.action = action
    if getattr(action, "slots", None):
        rig.animation_data.action_slot = action.slots[0]
    bpy.context.scene.frame_set(round(sum(action.frame_range) / 2))


def evaluated(objects: list[bpy.types.Object]) -> tuple[np.ndarray, np.ndarray]:
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    vertices, faces, count = [], [], 0
    for obj in objects:
        shown = obj.evaluated_get(graph)
        mesh = shown.to_mesh()
        own = np.empty(3 * len(mesh.vertices))
        mesh.vertices.foreach_get("co", own)
        mesh.calc_loop_triangles()
        triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        matrix = np.array(obj.matrix_world)
        vertices.append(own.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
        faces.append(triangles.reshape(-1, 3).astype(np.int64) + count)
        count += len(vertices[-1])
        shown.to_mesh_clear()
    return np.concatenate(vertices), np.concatenate(faces)


def timed(vertices: np.ndarray, faces: np.ndarray):
    began = perf_counter()
    return canonical_form(vertices, faces, Settings()), perf_counter() - began


def attachment(vertices: np.ndarray, pieces: list[Piece], form: np.ndarray, faces: np.ndarray) -> float:
    from scipy.spatial import KDTree

    unit = np.sqrt(surface_area(vertices, faces))
    samples = [sampled(piece.points / unit, piece.faces, 0.003) for piece in pieces]
    trees = [KDTree(each.points) for each in samples]
    changes = []
    for index, piece in enumerate(pieces):
        nearest, now = np.full(len(piece.vertices), np.inf), np.zeros(len(piece.vertices))
        for other, tree in enumerate(trees):
            if other == index:
                continue
            distance, at = tree.query(piece.points / unit, distance_upper_bound=NEAR)
            here = distance < nearest
            after = samples[other].on(form[pieces[other].vertices] / unit)[at[here]]
            nearest[here], now[here] = distance[here], np.linalg.norm(form[piece.vertices[here]] / unit - after, axis=1)
        changes.append(np.abs(now - nearest)[nearest < NEAR])
    near = np.concatenate(changes)
    return float(np.quantile(near, 0.95)) if len(near) else 0.0  # only one piece, or none near another


def distortion(piece: Piece, form: np.ndarray) -> float:
    return float(np.quantile(np.abs(edge_stretch(piece.points, form[piece.vertices], piece.faces) - 1), 0.95))


def spread(shapes: list[np.ndarray], faces: np.ndarray) -> float:
    """Return the mean distance between the shapes after rigid alignment, in sqrt(area)."""
    weights = vertex_areas(shapes[0], faces) + 1e-300
    apart = []
    for one, other in combinations(shapes, 2):
        rotation, shift = rigid_fit(one, other, weights)
        off = ((one @ rotation + shift - other) ** 2).sum(axis=1)
        apart.append(np.sqrt(weights @ off / weights.sum()))
    return float(np.mean(apart)) / np.sqrt(surface_area(shapes[0], faces))


if __name__ == "__main__":
    main([Path(each) for each in sys.argv[1:]])
