"""Sets of poses, of the largest piece: ``sets_of_poses.py [--whole] FOLDER|FILE.glb…`` (.obj files, or a rigged file).

For each set: pairs of poses in which a feature point has the number of another limb, alone and with the form of the
rest pose as reference; how far the forms on the reference are from it, over the same after the best rigid motion; the
rotations between upright forms.
"""

import sys
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import CanonicalForm, Settings, canonical_form  # noqa: E402
from addon.core.assembly.pieces import connected_pieces  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.mesh.geometry import vertex_areas  # noqa: E402
from tests.meshes.shapes import poses_of  # noqa: E402

POSES = 10  # of a rigged file, at most: clips of which every middle is another pose


def main(arguments: list[str]) -> None:
    whole = "--whole" in arguments
    print("| set | poses | numbers off | on a reference | apart, over the best fit | upright, median | upright, most |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for path in (Path(each) for each in arguments if each != "--whole"):
        poses, faces = poses_in(path) if whole else largest(*poses_in(path))
        poses = [pose for place, pose in enumerate(poses) if not any(np.allclose(pose, each) for each in poses[:place])]
        weights = vertex_areas(poses[0], faces)
        alone = [canonical_form(pose, faces, Settings(orientation="upright")) for pose in poses]
        led = [canonical_form(pose, faces, reference=alone[0]) for pose in poses]
        turns = [angle(one.vertices, two.vertices, weights) for one, two in combinations(alone, 2)]
        apart = max(over_best_fit(form.vertices, alone[0].vertices, weights) for form in led[1:])
        print(
            f"| {path.stem} | {len(poses)} | {pairs_off(alone)} | {pairs_off(led)} | {apart:.3f} |"
            f" {np.median(turns):.1f}° | {max(turns):.1f}° |",
            flush=True,
        )


def poses_in(path: Path) -> tuple[list[np.ndarray], np.ndarray]:
    if path.is_dir():
        poses = poses_of(path)
        return [vertices for _, vertices, _ in poses], poses[0][2]
    from tools.benchmarks.characters import posed  # needs Blender's module

    return posed(path, POSES)


def largest(poses: list[np.ndarray], faces: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    piece = max(connected_pieces(poses[0], faces).pieces, key=lambda each: len(each.vertices))
    return [pose[piece.vertices] for pose in poses], piece.faces


def angle(one: np.ndarray, other: np.ndarray, weights: np.ndarray) -> float:
    return float(np.degrees(Rotation.from_matrix(rigid_fit(one, other, weights)[0]).magnitude()))


def over_best_fit(form: np.ndarray, reference: np.ndarray, weights: np.ndarray) -> float:
    rotation, shift = rigid_fit(form, reference, weights)
    written, best = (
        np.sqrt(weights @ ((points - reference) ** 2).sum(axis=1)) for points in (form, form @ rotation + shift)
    )
    return float(written / best)


def pairs_off(forms: Sequence[CanonicalForm]) -> str:
    """Count pairs of poses in which the limb nearest to a feature point has another number; the surface is the same."""
    pairs = list(combinations(forms, 2))
    off = sum(not all_alike(one, two) for one, two in pairs)
    return f"{off} of {len(pairs)}"


def all_alike(one: CanonicalForm, other: CanonicalForm) -> bool:
    here, there = one.vertices[one.feature_points], one.vertices[other.feature_points]
    nearest = np.linalg.norm(here[:, None] - there, axis=2).argmin(axis=1)
    return bool((nearest == np.arange(len(here))).all())


if __name__ == "__main__":
    main(sys.argv[1:])
