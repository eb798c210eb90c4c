"""One mesh of every family that users bring, with the answer that is promised for it."""

from dataclasses import dataclass, field
from functools import cache

import numpy as np

from tests.meshes import shapes
from tests.meshes.shapes import Mesh


@dataclass(frozen=True, eq=False)
class Family:
    """A mesh and what is promised for it.

    `warns` and `refused` are words of the warning or the error; `like` names the family whose form it must have, up to
    `within` of its size, with `same` giving the vertex there of each vertex here, -1 for none.
    """

    vertices: np.ndarray
    faces: np.ndarray
    warns: str = ""
    refused: str = ""
    like: str = ""
    same: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    within: float = 1e-6
    scale: float = 1.0


@cache
def families() -> dict[str, Family]:
    """Make all of them, by name."""
    rng = np.random.default_rng(0)
    vertices, faces = shapes.figure()
    count = len(vertices)
    every = np.arange(count)
    found = {"closed": Family(vertices, faces)}

    hole = np.zeros(len(faces), dtype=bool)
    for centre in rng.choice(count, 4, replace=False):
        hole |= (np.linalg.norm(vertices - vertices[centre], axis=1) < 0.15)[faces].all(axis=1)
    found["holes"] = Family(*used(vertices, faces[~hole]))
    found["many borders"] = Family(*used(vertices, faces[spread_out(faces, rng)]))
    found["torus"] = Family(*torus(60, 24))
    found["genus 5"] = Family(*plate_with_holes())

    ball, its = shapes.sphere(3)
    small, its_own = shapes.joint(100, 30, 12, 2.0, 0.2)
    parts = np.vstack([vertices, ball * 0.4 + 4, small - 4])
    part_faces = np.vstack([faces, its + count, its_own + count + len(ball)])
    same = np.full(len(parts), -1)
    same[:count] = every
    found["loose parts"] = Family(parts, part_faces, "3 bodies", like="closed", same=same)
    many = [(shapes.sphere(1)[0] * (1 + 0.02 * number) + 5 * np.array([number // 10, number % 10, 0]))
            for number in range(100)]  # fmt: skip
    many_faces = [shapes.sphere(1)[1] + 42 * number for number in range(100)]
    found["100 parts"] = Family(np.vstack(many), np.vstack(many_faces), "bodies that do not touch")

    stray = np.vstack([vertices[:7], rng.normal(size=(40, 3)), vertices[7:]])
    to_stray = np.where(every < 7, every, every + 40)
    same = np.full(len(stray), -1)
    same[to_stray] = every
    found["isolated vertices"] = Family(
        stray, to_stray[faces], "40 vertices that belong to no face", like="closed", same=same
    )
    half = vertices[faces].mean(axis=1)[:, 2] > np.median(vertices[:, 2])
    cut, corners = np.unique(np.where(half[:, None], faces + count, faces), return_inverse=True)
    found["duplicate vertices"] = Family(
        vertices[cut % count], corners.reshape(-1, 3), "taken as joined", like="closed", same=cut % count
    )
    soup = Family(vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3), "taken as joined", like="closed",
                  same=faces.ravel())  # fmt: skip
    found["face soup"] = soup
    found["face soup, apart"] = Family(
        rng.normal(size=(1800, 3)), np.arange(1800).reshape(-1, 3), refused="600 loose parts"
    )
    found["duplicate faces"] = Family(vertices, np.vstack([faces, faces[::3]]), "duplicate", like="closed", same=every)
    turned = np.where((rng.uniform(size=len(faces)) < 0.3)[:, None], faces[:, ::-1], faces)
    found["flipped faces"] = Family(vertices, turned, "flipped to agree", like="closed", same=every)
    found["inside out"] = Family(vertices, faces[:, ::-1], like="closed", same=every, within=1e-3)
    found["one-sided, a border"] = Family(*moebius_band())
    found["one-sided, closed"] = Family(*klein_bottle())
    found["non-manifold edges"] = Family(*with_fins(vertices, faces))
    touching = np.vstack([ball, ball + np.array([2, 0, 0])])
    nearest = int(np.argmax(ball[:, 0])), int(np.argmin(ball[:, 0]))
    other = its + len(ball)
    other[other == len(ball) + nearest[1]] = nearest[0]
    found["non-manifold vertices"] = Family(*used(touching, np.vstack([its, other])))
    twice = np.vstack([faces, faces[:30, [0, 1, 1]]])
    found["faces of two vertices"] = Family(vertices, twice, "repeat", like="closed", same=every)
    flat = vertices.copy()
    for face in faces[rng.choice(len(faces), 30, replace=False)]:
        flat[face[0]] = flat[face[1]]
    found["zero-area faces"] = Family(flat, faces)
    needle = vertices.copy()
    for face in faces[rng.choice(len(faces), 30, replace=False)]:
        needle[face[0]] = needle[face[1]] + 1e-9 * (needle[face[0]] - needle[face[1]])
    found["needles"] = Family(needle, faces)
    found["slivers all over"] = Family(*shapes.cylinder(5, 3000))
    found["flat plane"] = Family(*shapes.grid(40, 30, 4.0, 3.0))
    found["sphere"] = Family(*shapes.sphere(4))
    tetrahedron = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    found["tetrahedron"] = Family(tetrahedron, np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]), "is small")
    found["one triangle"] = Family(np.eye(3), np.array([[0, 1, 2]]), "is small")
    for number in (0, 1, 2, 3):
        name = f"{number} vertices, no face"
        found[name] = Family(np.eye(3)[:number], np.zeros((0, 3), dtype=int), refused="no faces")
    found["no area"] = Family(np.outer(np.arange(5), [1.0, 2, 3]), np.array([[0, 1, 2], [2, 3, 4]]), refused="no area")
    for name, value in (("not a number", np.nan), ("infinite", np.inf)):
        spoilt = vertices.copy()
        spoilt[17, 1] = value
        found[name] = Family(spoilt, faces, refused="1 vertex has coordinates that are not numbers")
    for scale in (1e-30, 1e30):
        found[f"size {scale:.0e}"] = Family(scale * vertices, faces, like="closed", same=every, scale=scale)
    single = (1e-30 * vertices).astype(np.float32).astype(float)
    found["size 1e-30, single precision"] = Family(single, faces, like="closed", same=every, within=1e-2, scale=1e-30)
    found["far away"] = Family(vertices + 1e6, faces, like="closed", same=every, within=1e-4)
    found["far away, single precision"] = Family((vertices + 1e6).astype(np.float32).astype(float), faces, "rounded to")
    found["valence 10,000"] = Family(*spindle(10_000))
    found["self-intersection"] = Family(*crossing())
    return found


def used(vertices, faces) -> Mesh:
    """Drop the vertices of no face."""
    kept, corners = np.unique(faces, return_inverse=True)
    return vertices[kept], corners.reshape(-1, 3)


def spread_out(faces, rng):
    """Mark all faces but some that share no vertex with each other."""
    keep = np.ones(len(faces), dtype=bool)
    taken: set[int] = set()
    for index in rng.permutation(len(faces))[: len(faces) // 12]:
        if not taken & set(faces[index]):
            keep[index] = False
            taken |= set(faces[index])
    return keep


def tube(points):
    """Close a grid of points in both directions: (a, b, 3), the second round, the first given round already."""
    a, b = points.shape[:2]
    number = np.arange(a * b).reshape(a, b)
    return number, points.reshape(-1, 3)


def quads(a, b, c, d):
    """Two triangles each."""
    first, second = np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3)
    return np.vstack([first, second])


def torus(around, across) -> Mesh:
    """A torus, stretched so that nothing is symmetric."""
    u = np.linspace(0, 2 * np.pi, around, endpoint=False)[:, None]
    v = np.linspace(0, 2 * np.pi, across, endpoint=False)[None]
    r = 0.35 + 0.1 * np.cos(u)
    points = np.stack([(1 + r * np.cos(v)) * np.cos(u) * 1.4, (1 + r * np.cos(v)) * np.sin(u), r * np.sin(v)], axis=2)
    number, points = tube(points)
    after, right = np.roll(number, -1, axis=0), np.roll(number, -1, axis=1)
    return points, quads(number, after, np.roll(after, -1, axis=1), right)


def plate_with_holes() -> Mesh:
    """A bent slab with five holes through it."""
    axes = [np.linspace(-3.2, 3.2, 49), np.linspace(-1.2, 1.2, 19), np.linspace(-0.6, 0.6, 10)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    x, y, z = points.T
    slab = np.minimum.reduce([2.9 - np.abs(x), 0.9 - np.abs(y), 0.35 - np.abs(z)])
    holes = np.min([np.hypot(x - at, y) - 0.35 for at in np.linspace(-2.2, 2.2, 5)], axis=0)
    vertices, faces = shapes.level_set(points, np.minimum(slab, holes) + 1e-4 * np.sin(7 * x), [49, 19, 10])
    angle = vertices[:, 0] / 2.5
    radius = 2.5 - vertices[:, 2]
    return np.column_stack([radius * np.sin(angle), vertices[:, 1], 2.5 - radius * np.cos(angle)]), faces


def moebius_band(around=60, across=7) -> Mesh:
    """A band with one turn."""
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)[:, None]
    side = np.linspace(-0.3, 0.3, across)[None]
    radius = 1 + side * np.cos(turn / 2)
    points = np.stack([radius * np.cos(turn), radius * np.sin(turn), side * np.sin(turn / 2)], axis=2)
    number = np.arange(around * across).reshape(around, across)
    after = np.vstack([number[1:], number[:1, ::-1]])
    return points.reshape(-1, 3), quads(number[:, :-1], number[:, 1:], after[:, 1:], after[:, :-1])


def klein_bottle(around=60, across=24) -> Mesh:
    """A figure-eight tube closed with half a turn; it goes through itself."""
    u = np.linspace(0, 2 * np.pi, around, endpoint=False)[:, None]
    v = np.linspace(0, 2 * np.pi, across, endpoint=False)[None]
    out = 2 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
    points = np.stack(
        [out * np.cos(u), out * np.sin(u), np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)], axis=2
    )
    number = np.arange(around * across).reshape(around, across)
    after = np.vstack([number[1:], number[:1, (-np.arange(across)) % across]])
    return points.reshape(-1, 3), quads(number, np.roll(number, -1, axis=1), np.roll(after, -1, axis=1), after)


def with_fins(vertices, faces) -> Mesh:
    """The figure with a fin along edges of its surface."""
    pairs = np.unique(np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]]]), axis=1), axis=0)
    middle = vertices[pairs].mean(axis=1)
    chosen = pairs[(np.abs(middle[:, 2]) < 0.12) & (np.abs(middle[:, 0]) < 1.0)][::3]
    tips = vertices[chosen].mean(axis=1) + np.array([0, 0, 0.3])
    number = len(vertices) + np.arange(len(chosen))
    return np.vstack([vertices, tips]), np.vstack([faces, np.column_stack([chosen, number])])


def spindle(sides) -> Mesh:
    """Two apexes over a ring with a dent."""
    turn = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    radius = 1 + 0.3 * np.cos(3 * turn)
    ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0.2 * np.sin(2 * turn)])
    here, after = np.arange(sides), np.roll(np.arange(sides), -1)
    top, low = np.full(sides, sides), np.full(sides, sides + 1)
    faces = np.vstack([np.column_stack([here, after, top]), np.column_stack([after, here, low])])
    return np.vstack([ring, [[0, 0, 1.5], [0, 0, -1]]]), faces


def crossing() -> Mesh:
    """A limb bent so far that it goes through itself."""
    vertices, faces = shapes.joint(320, 80, 20, 6.0, 0.45)
    return vertices, faces
