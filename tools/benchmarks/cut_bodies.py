"""Bodies cut at neck, wrists and ankles: ``cut_bodies.py FOLDER…`` (poses of a human with five limbs, as .obj files).

For each way to cut: distance of the form from that of the uncut mesh, after rigid alignment, in sqrt(area), by pose.
*shrunk*: every piece is shrunk by .001; *inserted*: it reaches .025 into its neighbour and is shrunk by .004.
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import canonical_form, distance_field  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.mesh.geometry import surface_area, vertex_areas, vertex_normals  # noqa: E402
from tests.meshes.shapes import poses_of  # noqa: E402

CUTS = {"shrunk": (0.0, 0.001), "inserted": (0.025, 0.004)}
HEAD, HAND, FOOT = 0.22, 0.14, 0.15  # distance of a cut from the end of the limb, in sqrt(area)


def main(folders: list[Path]) -> None:
    print("| body | cut | features | apart, median | most |")
    print("| --- | --- | --- | --- | --- |")
    for folder in folders:
        poses = poses_of(folder)
        rest, faces = poses[0][1:]
        limbs = canonical_form(rest, faces).feature_points
        away = np.stack([distance_field(rest, faces, [limb]) for limb in limbs], axis=1)
        away /= np.sqrt(surface_area(rest, faces))
        height = np.argsort(np.argsort(rest[limbs, np.argmax(np.ptp(rest, axis=0))]))
        where = np.array([FOOT, FOOT, HAND, HAND, HEAD])[height]
        uncut = [canonical_form(pose, faces).vertices for _, pose, _ in poses]
        for name, (inserted, shrunk) in CUTS.items():
            pieces = pieces_of(faces, away, where, inserted)
            apart, features = [], set()
            for (_, pose, _), form in zip(poses, uncut, strict=True):
                unit = float(np.sqrt(surface_area(pose, faces)))
                vertices, corners, source = put_apart(pose, faces, pieces, shrunk * unit)
                found = canonical_form(vertices, corners)
                weights = vertex_areas(pose, faces)[source]
                rotation, shift = rigid_fit(found.vertices, form[source], weights)
                off = ((found.vertices @ rotation + shift - form[source]) ** 2).sum(axis=1)
                apart.append(np.sqrt(weights @ off / weights.sum()) / unit)
                features.add(len(found.feature_points))
            numbers = ", ".join(map(str, sorted(features)))
            print(f"| {folder.name} | {name} | {numbers} | {np.median(apart):.3f} | {max(apart):.3f} |", flush=True)


def pieces_of(faces: np.ndarray, away: np.ndarray, where: np.ndarray, inserted: float) -> list[np.ndarray]:
    """List the triangles of the trunk, then of each end; ends reach into the trunk."""
    farthest = away[faces].max(axis=1)  # (m, k)
    ends = [np.flatnonzero(farthest[:, limb] < cut + inserted) for limb, cut in enumerate(where)]
    return [np.flatnonzero((farthest >= where).all(axis=1)), *ends]


def put_apart(
    vertices: np.ndarray, faces: np.ndarray, pieces: list[np.ndarray], shrunk: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give each piece vertices of its own; return these, the triangles, and the vertex from which each comes."""
    inside = vertices - shrunk * vertex_normals(vertices, faces)
    corners, source, count = [], [], 0
    for number, piece in enumerate(pieces):
        own, index = np.unique(faces[piece], return_inverse=True)
        corners.append(index.reshape(-1, 3) + count)
        source.append(own)
        count += len(own)
        if number == 0:
            trunk = len(own)
    origin = np.concatenate(source)
    return np.concatenate([vertices[origin[:trunk]], inside[origin[trunk:]]]), np.concatenate(corners), origin


if __name__ == "__main__":
    main([Path(each) for each in sys.argv[1:]])
