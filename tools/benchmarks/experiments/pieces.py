"""Characters of many pieces: rigged files, skins with scales, and scans cut apart."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial import KDTree

from addon.core import canonical_form, distance_field
from addon.core.assembly.contacts import sampled
from addon.core.assembly.pieces import Piece, connected_pieces
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.geometry import surface_area, vertex_areas, vertex_normals
from addon.evaluation.tables import mean_apart
from tests.meshes.pieced import with_scales
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.experiments.forms import several
from tools.benchmarks.measuring import timed
from tools.benchmarks.mesh_sets import Body, creatures, humans, pose_ratio

POSES = 6
NEAR = 0.02
SCALES, HEIGHT = (100, 1000, 9000), 0.004
CUTS = {"shrunk": (0.0, 0.001), "inserted": (0.025, 0.004)}
HEAD, HAND, FOOT = 0.22, 0.14, 0.15  # distance of a cut from the end of the limb


@experiment("characters", creatures)
def characters(body: Body, _: None) -> Iterator[Row]:
    """Rigged files in up to 6 poses: their clips, or bones turned at random (arms by up to 45° about each axis,
    legs by 35°). *attachment*: change of the distance from the nearest point of another piece, for vertices
    nearer than .02, 95th percentile, median over the poses and the most; *worst piece*: edge distortion of the
    piece where it is largest, 95th percentile, likewise.
    """
    poses, faces = body.some(POSES), body.poses.faces
    forms, seconds = zip(*(timed(canonical_form, pose, faces) for pose in poses), strict=True)
    pieces = [connected_pieces(pose, faces).pieces for pose in poses]
    attached = [
        attachment(pose, own, form.vertices, faces) for pose, own, form in zip(poses, pieces, forms, strict=True)
    ]
    worst = [max(distortion(piece, form.vertices) for piece in own) for own, form in zip(pieces, forms, strict=True)]
    yield {
        "poses": len(poses),
        "pieces": len(pieces[0]),
        "features": several(len(form.feature_points) for form in forms),
        "attachment": np.median(attached),
        "most": max(attached),
        "worst piece": np.median(worst),
        "worst of all": max(worst),
        "pose ratio": pose_ratio(poses, [form.vertices for form in forms], faces),
        "seconds": np.median(seconds),
    }


def attachment(vertices: np.ndarray, pieces: list[Piece], form: np.ndarray, faces: np.ndarray) -> float:
    """Return by how much vertices near another piece change their distance from it, 95th percentile."""
    size = np.sqrt(surface_area(vertices, faces))
    samples = [sampled(piece.points / size, piece.faces, 0.003) for piece in pieces]
    trees = [KDTree(each.points) for each in samples]
    changes = [np.zeros(1)]  # only one piece, or none near another
    for index, piece in enumerate(pieces):
        nearest, now = np.full(len(piece.vertices), np.inf), np.zeros(len(piece.vertices))
        for other in set(range(len(pieces))) - {index}:
            distance, at = trees[other].query(piece.points / size, distance_upper_bound=NEAR)
            here = distance < nearest
            after = samples[other].on(form[pieces[other].vertices] / size)[at[here]]
            nearest[here], now[here] = distance[here], np.linalg.norm(form[piece.vertices[here]] / size - after, axis=1)
        changes.append(np.abs(now - nearest)[nearest < NEAR])
    return float(np.quantile(np.concatenate(changes), 0.95))


def distortion(piece: Piece, form: np.ndarray) -> float:
    """Return the edge distortion of a piece, 95th percentile."""
    return float(np.quantile(np.abs(edge_stretch(piece.points, form[piece.vertices], piece.faces) - 1), 0.95))


@experiment("scales", creatures)
def scales(body: Body, _: None) -> Iterator[Row]:
    """Small squares on the skin of a character in its second pose. *skin*: distance of the skin's form from that
    without them; *scale*: change of the distance from a square to the skin under it, 95th percentile.
    """
    skin, faces = body.poses.vertices[1], body.poses.faces
    bare, before = min((timed(canonical_form, skin, faces) for _ in range(2)), key=lambda run: run[1])
    size = np.sqrt(surface_area(bare.vertices, faces))
    for count in SCALES:
        vertices, corners, under = with_scales(skin, faces, min(count, len(faces)), HEIGHT)
        form, seconds = min((timed(canonical_form, vertices, corners) for _ in range(2)), key=lambda run: run[1])
        below = form.vertices[faces[under]].mean(axis=1)
        above = form.vertices[-4 * len(under) :].reshape(-1, 4, 3).mean(axis=1)
        unit = np.sqrt(surface_area(form.vertices, faces))
        yield {
            "scales": len(under),
            "vertices": len(vertices),
            "pieces": len(connected_pieces(vertices, corners).pieces),
            "features": len(form.feature_points),
            "skin": mean_apart([form.vertices[: len(skin)], bare.vertices]) / size,
            "scale": np.quantile(np.abs(np.linalg.norm(above - below, axis=1) / unit - HEIGHT), 0.95),
            "time / without": seconds / before,
        }


@experiment("cuts", humans, settings=CUTS)
def cut(body: Body, how: tuple[float, float]) -> Iterator[Row]:
    """Bodies of five limbs cut at neck, wrists and ankles: distance of the form from that of the whole mesh, over
    its poses. *shrunk*: every piece is shrunk by .001; *inserted*: it reaches .025 into its neighbour, shrunk by
    .004.
    """
    inserted, shrunk = how
    poses, faces = body.poses[1:]
    limbs = canonical_form(poses[0], faces).feature_points
    away = np.stack([distance_field(poses[0], faces, [limb]) for limb in limbs], axis=1)
    away = (away / np.sqrt(surface_area(poses[0], faces)))[faces].max(axis=1)  # (m, k) of triangles from the ends
    height = np.argsort(np.argsort(poses[0][limbs, np.argmax(np.ptp(poses[0], axis=0))]))
    where = np.array([FOOT, FOOT, HAND, HAND, HEAD])[height]
    ends = [np.flatnonzero(away[:, limb] < end + inserted) for limb, end in enumerate(where)]
    pieces = [np.flatnonzero((away >= where).all(axis=1)), *ends]
    apart, features = [], []
    for pose in poses:
        unit = float(np.sqrt(surface_area(pose, faces)))
        whole = canonical_form(pose, faces).vertices
        vertices, corners, source = put_apart(pose, faces, pieces, shrunk * unit)
        found = canonical_form(vertices, corners)
        weights = vertex_areas(pose, faces)[source]
        rotation, shift = rigid_fit(found.vertices, whole[source], weights)
        off = ((found.vertices @ rotation + shift - whole[source]) ** 2).sum(axis=1)
        apart.append(np.sqrt(weights @ off / weights.sum()) / unit)
        features.append(len(found.feature_points))
    yield {"features": several(features), "apart, median": np.median(apart), "most": max(apart)}


def put_apart(
    vertices: np.ndarray, faces: np.ndarray, pieces: list[np.ndarray], shrunk: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give each piece its own vertices, all but the first shrunk; return mesh and source of each vertex."""
    inside = vertices - shrunk * vertex_normals(vertices, faces)
    corners, points = [], []
    source: list[np.ndarray] = []
    for number, piece in enumerate(pieces):
        own, index = np.unique(faces[piece], return_inverse=True)
        corners.append(index.reshape(-1, 3) + sum(map(len, source)))
        source.append(own)
        points.append((inside if number else vertices)[own])
    return np.concatenate(points), np.concatenate(corners), np.concatenate(source)
