"""Measures forms of animals that no threshold but one was chosen by: ``game_animals.py ART [NAME …]``.

ART is the folder art of the game 0 A.D. (Wildfire Games, CC-BY-SA 3.0; ``public.zip`` of Debian's package 0ad-data).
Every animal is posed by the middles of up to six clips, welded, and subdivided to 3,000 vertices or more.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import CanonicalForm, canonical_form, match  # noqa: E402
from addon.core.measures.form_measures import edge_stretch  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from addon.evaluation.tables import mean_apart  # noqa: E402
from tests.meshes.shapes import midpoints  # noqa: E402
from tools.benchmarks.sets_of_poses import pairs_off  # noqa: E402

CLIPS = 6
MIDDLE = 0.3  # of a clip: in the middle of most, a walking animal stands as at the start
LEAST = 3_000  # vertices: the game's own have 100 to 1,500
ANIMALS = {
    "animal_boar": "animal_boar",
    "animal_lion": "lion",
    "camel": "camel",
    "cattle_female_a": "bovidae",
    "chicken": "chicken",
    "Croc": "Croc",
    "deer_mesh": "deer",
    "donkey": "donkey",
    "elephant_african_baby": "elephant_infant",
    "elephant_african_bush": "elephant_african_bush",
    "fauna_hippopotamus": "hippopotamus",
    "fox": "fox",
    "giraffe_adult": "giraffe_adult",
    "goat_male": "goat",
    "mastiff": "mastiff",
    "pig": "animal_pig",
    "rabbit_01": "rabbit",
    "rhino": "rhino",
    "sheep": "sheep",
    "tiger": "feline",
    "wildebeest_adult": "bovidae",
    "wolf": "wolf",
    "wolfhound": "wolfhound",
    "zebra": "zebra",
    "zebu": "bovidae",
}  # mesh and what its clips begin with

PLACES = 1e5  # positions over the extent that count as different


def main(art: Path, names: list[str]) -> None:
    print(
        "| animal | poses | vertices | feature points | numbers off | on a reference | asymmetry, worst |"
        " edge distortion, median | 95th percentile | poses apart | pose ratio | match, mean | match, worst |\n"
        + "| --- " * 13
        + "|"
    )
    for name in names or ANIMALS:
        poses, faces = posed(art, name, ANIMALS[name])
        print(row(name, poses, faces), flush=True)


def row(name: str, poses: list[np.ndarray], faces: np.ndarray) -> str:
    unit = np.sqrt(surface_area(poses[0], faces))
    alone = [canonical_form(pose, faces) for pose in poses]
    led = [canonical_form(pose, faces, reference=alone[0]) for pose in poses]
    counts = sorted({len(form.feature_points) for form in alone})
    numbers = [pairs_off(forms) if len(counts) == 1 else "" for forms in (alone, led)]
    asymmetric = max((form.asymmetry for form in alone if np.isfinite(form.asymmetry)), default=np.nan)
    distorted = np.mean(
        [np.quantile(distortion(pose, form, faces), (0.5, 0.95)) for pose, form in zip(poses, alone, strict=True)], 0
    )
    apart = mean_apart(poses) / unit
    wrong = [mismatch(one, other, faces) / unit for one, other in pairwise([*poses, poses[0]])]
    ratio = mean_apart([form.vertices for form in alone]) / unit / apart
    return (
        f"| {name} | {len(poses)} | {len(poses[0]):,} | {', '.join(map(str, counts))} | {numbers[0]} | {numbers[1]} |"
        f" {asymmetric:.3f} | {distorted[0]:.1%} | {distorted[1]:.1%} | {apart:.3f} | {ratio:.2f} |"
        f" {100 * np.mean(wrong):.2f} | {100 * max(wrong):.2f} |"
    )


def mismatch(one: np.ndarray, other: np.ndarray, faces: np.ndarray) -> float:
    """Match a pose with another one, its vertices shuffled; return the mean distance from the truth."""
    shuffled = np.random.default_rng(0).permutation(len(other))
    found = match(one, faces, other[shuffled], np.argsort(shuffled)[faces])
    return float(np.linalg.norm(other[shuffled[found.vertices]] - other, axis=1).mean())


def distortion(pose: np.ndarray, form: CanonicalForm, faces: np.ndarray) -> np.ndarray:
    stretch = edge_stretch(pose, form.vertices, faces)
    return np.abs(stretch[np.isfinite(stretch)] - 1)


def posed(art: Path, name: str, clips: str) -> tuple[list[np.ndarray], np.ndarray]:
    """Read an animal in several poses, welded and subdivided."""
    rest, bones, weights, faces, bind = read_mesh(art / "meshes" / "skeletal" / f"{name}.dae.cached.pmd")
    files = sorted((art / "animation" / "quadraped").glob(f"{clips}_*.psa"))
    moves = [move for move in map(read_clip, files) if move.shape[1] == len(bind)]
    moves = [moves[place] for place in np.unique(np.linspace(0, len(moves) - 1, CLIPS).astype(int))]
    back, flat = np.linalg.inv(matrices(bind)), np.column_stack([rest, np.ones(len(rest))])
    places = [rest]
    for move in moves:
        turned = np.concatenate([matrices(move[int(MIDDLE * (len(move) - 1))]) @ back, np.eye(4)[None]])
        places.append(np.einsum("nk,nkij,nj->ni", weights, turned[np.minimum(bones, len(bind))], flat)[:, :3])
    at = np.round(np.concatenate(places, axis=1) / np.ptp(rest) * PLACES).astype(np.int64)
    _, first, corner = np.unique(at, axis=0, return_index=True, return_inverse=True)
    faces = corner.ravel()[faces]
    used, corners = np.unique(faces, return_inverse=True)
    together = np.concatenate(places, axis=1)[first][used]  # (n, 3 (p + 1)): all poses are subdivided at once
    faces = corners.reshape(-1, 3)
    while len(together) < LEAST:
        together, faces = midpoints(together, faces)
    return list(np.split(together, len(places), axis=1))[1:], faces


def read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Read vertices, four bones and weights of each, triangles, and bones (position and quaternion) of a .pmd file."""
    data = path.read_bytes()
    version, _, count = np.frombuffer(data, "<u4", 3, 4)
    layers = int(np.frombuffer(data, "<u4", 1, 16)[0]) if version >= 4 else 1
    record = np.dtype(
        [
            ("position", "<f4", 3),
            ("normal", "<f4", 3),
            ("uv", "<f4", (layers, 2)),
            ("bones", "u1", 4),
            ("weights", "<f4", 4),
        ]
    )
    start = 20 if version >= 4 else 16
    vertices = np.frombuffer(data, record, count, start)
    start += int(count) * record.itemsize
    triangles = int(np.frombuffer(data, "<u4", 1, start)[0])
    faces = np.frombuffer(data, "<u2", 3 * triangles, start + 4).reshape(-1, 3).astype(np.int64)
    start += 4 + 6 * triangles
    bones = int(np.frombuffer(data, "<u4", 1, start)[0])
    bind = np.frombuffer(data, "<f4", 7 * bones, start + 4).reshape(-1, 7)
    weights = vertices["weights"] / vertices["weights"].sum(axis=1, keepdims=True)
    return vertices["position"].astype(float), vertices["bones"].astype(int), weights.astype(float), faces, bind


def read_clip(path: Path) -> np.ndarray:
    """Read position and quaternion of all bones in all frames of a .psa file, (frames, bones, 7)."""
    data = path.read_bytes()
    start = 16 + int(np.frombuffer(data, "<u4", 1, 12)[0])  # after the name
    bones, frames = np.frombuffer(data, "<u4", 2, start + 4)
    return np.frombuffer(data, "<f4", 7 * int(bones) * int(frames), start + 12).reshape(frames, bones, 7)


def matrices(states: np.ndarray) -> np.ndarray:
    """Turn positions and quaternions of bones into their matrices, (b, 4, 4)."""
    result = np.tile(np.eye(4), (len(states), 1, 1))
    result[:, :3, :3] = Rotation.from_quat(states[:, 3:]).as_matrix()
    result[:, :3, 3] = states[:, :3]
    return result


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
