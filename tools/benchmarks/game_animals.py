"""Animals that were not used in development: those of the game 0 A.D. (Wildfire Games, CC-BY-SA 3.0).

DATA is the folder ``art`` of the game's ``public.zip`` (Debian's package 0ad-data). Every animal is posed by the
middles of up to six clips, welded, and subdivided to 3,000 vertices or more.
"""

from functools import partial
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from tests.meshes.shapes import midpoints
from tools.benchmarks.mesh_sets import Body, Poses

CLIPS = 6
MIDDLE = 0.3  # of a clip: in the middle of most, a walking animal stands as at the start
LEAST = 3_000  # vertices: the game's own have 100 to 1,500
PLACES = 1e5  # positions over the extent that count as different
ANIMALS = {  # mesh, and what the files of its clips begin with
    "animal_boar": "animal_boar", "animal_lion": "lion", "camel": "camel", "cattle_female_a": "bovidae",
    "chicken": "chicken", "Croc": "Croc", "deer_mesh": "deer", "donkey": "donkey",
    "elephant_african_baby": "elephant_infant", "elephant_african_bush": "elephant_african_bush",
    "fauna_hippopotamus": "hippopotamus", "fox": "fox", "giraffe_adult": "giraffe_adult", "goat_male": "goat",
    "mastiff": "mastiff", "pig": "animal_pig", "rabbit_01": "rabbit", "rhino": "rhino", "sheep": "sheep",
    "tiger": "feline", "wildebeest_adult": "bovidae", "wolf": "wolf", "wolfhound": "wolfhound", "zebra": "zebra",
    "zebu": "bovidae",
}  # fmt: skip


def animals(art: Path | None) -> list[Body]:
    """Return the animals whose meshes are in the folder `art` of the game."""
    files = {name: art / "meshes" / "skeletal" / f"{name}.dae.cached.pmd" for name in ANIMALS} if art else {}
    return [
        Body(name, partial(posed, file, clips), (file, *clips))
        for name, file in files.items()
        if file.is_file() and (clips := tuple(sorted(art.glob(f"animation/quadraped/{ANIMALS[name]}_*.psa"))))  # type: ignore[union-attr]
    ]


def posed(file: Path, clips: tuple[Path, ...]) -> Poses:
    """Read an animal in several poses, welded and subdivided."""
    rest, bones, weights, faces, bind = read_mesh(file)
    moves = [move for move in map(read_clip, clips) if move.shape[1] == len(bind)]
    moves = [moves[place] for place in np.unique(np.linspace(0, len(moves) - 1, CLIPS).astype(int))]
    back, flat = np.linalg.inv(matrices(bind)), np.column_stack([rest, np.ones(len(rest))])
    places = [rest]
    for move in moves:
        turned = np.concatenate([matrices(move[int(MIDDLE * (len(move) - 1))]) @ back, np.eye(4)[None]])
        places.append(np.einsum("nk,nkij,nj->ni", weights, turned[np.minimum(bones, len(bind))], flat)[:, :3])
    at = np.round(np.concatenate(places, axis=1) / np.ptp(rest) * PLACES).astype(np.int64)
    _, first, corner = np.unique(at, axis=0, return_index=True, return_inverse=True)
    used, corners = np.unique(corner.ravel()[faces], return_inverse=True)
    together = np.concatenate(places, axis=1)[first][used]  # (n, 3 (p + 1)): all poses are subdivided at once
    faces = corners.reshape(-1, 3)
    while len(together) < LEAST:
        together, faces = midpoints(together, faces)
    poses = list(np.split(together, len(places), axis=1))[1:]
    return Poses([f"clip {number}" for number in range(len(poses))], poses, faces)


def read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Read vertices, four bones and weights of each, triangles, and bones (position and quaternion) of a .pmd file."""
    data = path.read_bytes()
    version, _, count = np.frombuffer(data, "<u4", 3, 4)
    layers = int(np.frombuffer(data, "<u4", 1, 16)[0]) if version >= 4 else 1
    record = np.dtype([("position", "<f4", 3), ("normal", "<f4", 3), ("uv", "<f4", (layers, 2)), ("bones", "u1", 4),
                       ("weights", "<f4", 4)])  # fmt: skip
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
