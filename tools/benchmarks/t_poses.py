"""Limbs of bodies in T-pose: ``t_poses.py FOLDER…``, poses of one two-legged mesh each as .obj, of which five are used.

Every pose is posed like the mannequin. A limb goes from the centre of one ring around it to the next: the points at
given distances from the tip of the hand or foot, in sqrt(area), on the body in its first pose and on the mannequin.
Printed is the angle between the limb and the mannequin's, after a rigid fit of the whole body.
"""

import sys
from pathlib import Path

import numpy as np
import potpourri3d

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import canonical_form, mannequin, pose_like, transferred  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from tests.meshes.shapes import poses_of  # noqa: E402

POSES = 5
RINGS = {"hand": ((0.25, 0.28), (0.42, 0.45), (0.60, 0.63)), "foot": ((0.15, 0.18), (0.45, 0.48), (0.70, 0.73))}
LIMBS = {"hand": ("forearms", "upper arms"), "foot": ("shins", "thighs")}
RIGHT = 8.0  # degrees
ON_GROUND = 0.03  # metres


def main(folders: list[Path]) -> None:
    model = mannequin()
    tips = tips_of(model[0])
    wanted = limbs(model[0], rings(model, tips))
    angles: dict[str, list[float]] = {limb: [] for pair in LIMBS.values() for limb in pair}
    for folder in folders:
        bodies = [(vertices, faces) for _, vertices, faces in poses_of(folder)[:POSES]]
        features = canonical_form(*bodies[0]).feature_points
        for body in bodies:
            posed = pose_like(*body, *model)
            places = transferred(posed.match, model[0])
            rotation, shift = rigid_fit(posed.vertices, places)
            nearest = {
                name: features[np.linalg.norm(places[features] - model[0][tip], axis=1).argmin()]
                for name, tip in tips.items()
            }
            here = limbs(posed.vertices @ rotation + shift, rings(bodies[0], nearest))
            for (name, limb), way in here.items():
                cosine = way @ wanted[name, limb] / np.linalg.norm(way) / np.linalg.norm(wanted[name, limb])
                angles[limb].append(float(np.degrees(np.arccos(min(cosine, 1.0)))))
    print("| | mean | most | within 8° |")
    print("| --- | --- | --- | --- |")
    angles["all"] = [angle for each in angles.values() for angle in each]
    for limb, found in angles.items():
        print(f"| {limb} | {np.mean(found):.1f}° | {max(found):.1f}° | {np.mean(np.array(found) <= RIGHT):.0%} |")


def tips_of(vertices: np.ndarray) -> dict[str, int]:
    """Return the tips of the mannequin's hands and feet, by kind and side."""
    low = np.flatnonzero(vertices[:, 2] < ON_GROUND)
    across = vertices[:, 0]
    return {
        "hand, left": int(across.argmax()),
        "hand, right": int(across.argmin()),
        "foot, left": int(low[across[low].argmax()]),
        "foot, right": int(low[across[low].argmin()]),
    }


def rings(body: tuple[np.ndarray, np.ndarray], tips: dict[str, int]) -> dict[str, list[np.ndarray]]:
    """Return the vertices of the rings around each limb."""
    solver, unit = potpourri3d.MeshHeatMethodDistanceSolver(*body), np.sqrt(surface_area(*body))
    far = {name: solver.compute_distance(int(tip)) / unit for name, tip in tips.items()}
    return {
        name: [np.flatnonzero((each >= low) & (each < high)) for low, high in RINGS[name[:4]]]
        for name, each in far.items()
    }


def limbs(vertices: np.ndarray, around: dict[str, list[np.ndarray]]) -> dict[tuple[str, str], np.ndarray]:
    """Return the direction of each limb."""
    found = {}
    for name, each in around.items():
        centres = [vertices[ring].mean(axis=0) for ring in each]
        for limb, start, end in zip(LIMBS[name[:4]], centres[:-1], centres[1:], strict=True):
            found[name, limb] = end - start
    return found


if __name__ == "__main__":
    main([Path(name) for name in sys.argv[1:]])
