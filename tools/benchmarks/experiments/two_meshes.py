"""What one mesh takes from another: weights of a rig, and the pose of the mannequin."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from addon.core import distance_field, mannequin, match, stance_by_match, transferred
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area
from addon.evaluation.correspondences.work import Mesh, remeshed
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.mesh_sets import Body, creatures, humans, open_rigged, rig_poses, shown

POSES, T_POSES = 6, 5
RINGS = {  # of a limb of the mannequin, between two distances from its tip in sqrt(area), and the parts between them
    "hand": (((0.25, 0.28), (0.42, 0.45), (0.60, 0.63)), ("forearms", "upper arms")),
    "foot": (((0.15, 0.18), (0.45, 0.48), (0.70, 0.73)), ("shins", "thighs")),
}
RIGHT = 8.0  # degrees
ON_GROUND = 0.03  # metres


def characters_without_clips(data: Path | None) -> list[Body]:
    """Return the rigged humans: their bones are turned at random, so that all of their motions are known."""
    return [body for body in creatures(data) if body.name.startswith("human")]


@experiment("weights", characters_without_clips)
def weights(body: Body, _: None) -> Iterator[Row]:
    """Weights of a rigged character in its rest pose, transferred to five other poses that are reduced to 70 % of
    their vertices and shuffled, and each then posed by the rig as the next one. *difference*: mean over all
    weights, and *half sum* of the differences at a vertex; *posed*: distance from the same with the true weights.
    """
    rig, objects = open_rigged(body.files[0])
    bones = [bone.name for bone in rig.data.bones if bone.use_deform]
    given = weights_of(objects, bones)
    poses, turns = [], []
    for _number in rig_poses(rig, POSES):
        pose, faces = shown(objects)
        poses.append(pose)
        turns.append(motions(rig, bones))
    root = np.sqrt(surface_area(poses[0], faces))
    entries, sums, moved, apart = [], [], [], []
    for number in range(1, len(poses)):
        other = number % (len(poses) - 1) + 1
        reduced = remeshed(Mesh(poses[number], faces))
        place = {tuple(point): vertex for vertex, point in enumerate(poses[number])}
        true = given[
            [place[tuple(point)] for point in reduced.vertices]
        ]  # the vertices that are left have their weights
        got = transferred(match(*reduced, poses[0], faces), given)
        way = turns[other] @ np.linalg.inv(turns[number])
        ends = [blended(each, reduced.vertices, way) for each in (got, true)]
        entries.append(np.abs(got - true).mean())
        sums.append(np.abs(got - true).sum(axis=1).mean() / 2)
        moved.append(rms(ends[0] - ends[1]) / root)
        apart.append(rms(poses[number] - poses[other]) / root)
    yield {
        "bones": len(bones),
        "difference": np.mean(entries),
        "half sum": np.mean(sums),
        "posed": np.mean(moved),
        "posed, most": max(moved),
        "poses apart": np.mean(apart),
    }


def weights_of(objects: list[Any], bones: list[str]) -> np.ndarray:
    """Read the weights of the vertices of objects; (n, bones), rows sum to 1."""
    parts = []
    for obj in objects:
        column = {group.index: bones.index(group.name) for group in obj.vertex_groups if group.name in bones}
        own = np.zeros((len(obj.data.vertices), len(bones)))
        for vertex in obj.data.vertices:
            for part in vertex.groups:
                if part.group in column:
                    own[vertex.index, column[part.group]] += part.weight
        parts.append(own)
    weights = np.concatenate(parts)
    return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-9)


def motions(rig: Any, bones: list[str]) -> np.ndarray:
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
    """Return the root mean square length of vectors."""
    return float(np.sqrt((way**2).sum(axis=1).mean()))


def by_limb(rows: list[Row]) -> list[Row]:
    """Return a row for each part of a limb, and one for all."""
    table = []
    for limb in (*dict.fromkeys(row["limb"] for row in rows), "all"):
        angles = np.array([row["degrees"] for row in rows if limb in ("all", row["limb"])])
        table.append({"limb": limb, "mean": float(angles.mean()), "most": float(angles.max()),
                      "right": float((angles <= RIGHT).mean())})  # fmt: skip
    return table


@experiment("t-poses", humans, table=by_limb)
def t_poses(body: Body, _: None) -> Iterator[Row]:
    """Humans in five poses, in a T-pose: degrees between their limbs and the mannequin's, from the centre
    of a ring around a limb to that of the next, where the match puts the mannequin's rings. *right*: within 8°.
    """
    model = mannequin()
    rings, parts = rings_of_mannequin(*model)
    for pose in body.some(T_POSES):
        posed = stance_by_match(pose, body.poses.faces, anyway=True)
        rotation, shift = rigid_fit(posed.vertices, transferred(posed.match, model[0]))
        wanted = directions(model[0], rings)
        found = directions(posed.vertices @ rotation + shift, transferred(posed.match, rings))
        for limb, one, other in zip(parts, wanted, found, strict=True):
            cosine = one @ other / np.linalg.norm(one) / np.linalg.norm(other)
            yield {"limb": limb, "degrees": np.degrees(np.arccos(min(cosine, 1.0)))}


def rings_of_mannequin(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return which vertices are in each ring, (n, 3 limbs), and the names of the parts between the rings."""
    low, across = np.flatnonzero(vertices[:, 2] < ON_GROUND), vertices[:, 0]
    hands, feet = (across.argmin(), across.argmax()), (low[across[low].argmin()], low[across[low].argmax()])
    inside: list[np.ndarray] = []
    parts: list[str] = []
    for kind, tips in (("hand", hands), ("foot", feet)):
        for tip in tips:
            away = distance_field(vertices, faces, [int(tip)]) / np.sqrt(surface_area(vertices, faces))
            inside += [(away >= near) & (away < far) for near, far in RINGS[kind][0]]
            parts += RINGS[kind][1]
    return np.column_stack(inside).astype(float), parts


def directions(vertices: np.ndarray, rings: np.ndarray) -> np.ndarray:
    """Return the ways from the centre of each ring to that of the next on the same limb."""
    centres = (rings.T @ vertices / rings.sum(axis=0)[:, None]).reshape(-1, 3, 3)
    return np.diff(centres, axis=1).reshape(-1, 3)
