"""Shapes made by formulas, for tests: arrays of vertices and triangles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from addon.core.surface.triangulation import Triangulation

Mesh = tuple[np.ndarray, np.ndarray]  # vertices and triangles
Limb = tuple[Sequence[tuple[float, float, float]], float]  # points of its middle line, and its width


def sphere(subdivisions: int) -> Mesh:
    """An icosahedron subdivided and blown up to radius 1: 10·4^s + 2 vertices."""
    golden = (1 + 5**0.5) / 2
    vertices = np.array([(s * a, t * b, 0) for a, b in [(1, golden)] for s in (1, -1) for t in (1, -1)], dtype=float)
    vertices = np.concatenate([np.roll(vertices, shift, axis=1) for shift in range(3)])
    apart = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    near = np.abs(apart - 2) < 1e-9
    corners = [
        (i, j, k)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    faces = np.array(corners)
    inward = np.linalg.det(vertices[faces]) < 0
    faces[inward] = faces[inward][:, ::-1]
    for _ in range(subdivisions):
        vertices, faces = midpoints(vertices, faces)
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def midpoints(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    """Split every triangle in four."""
    sides = np.sort(np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1), axis=2)  # (m, 3, 2)
    unique, number = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(vertices) + number.reshape(-1, 3)
    vertices = np.concatenate([vertices, vertices[unique].mean(axis=1)])
    corner = [np.column_stack([faces[:, i], middle[:, (i + 2) % 3], middle[:, (i + 1) % 3]]) for i in range(3)]
    return vertices, np.concatenate([*corner, middle])


def grid(columns: int, rows: int, width: float = 1.0, height: float = 1.0) -> Mesh:
    """A flat rectangle with a border, diagonals alternating."""
    x, y = np.meshgrid(np.linspace(0, width, columns), np.linspace(0, height, rows))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(columns * rows)])
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    odd = ((corner // columns + corner % columns) % 2 == 1)[:, None]
    a, b, c, d = corner, corner + 1, corner + columns + 1, corner + columns
    first = np.where(odd, np.column_stack([a, b, d]), np.column_stack([a, b, c]))
    second = np.where(odd, np.column_stack([b, c, d]), np.column_stack([a, c, d]))
    return vertices, np.concatenate([first, second])


def cylinder(around: int, along: int, radius: float = 1.0, height: float = 4.0) -> Mesh:
    """An open tube."""
    flat, faces = grid(around + 1, along, 2 * np.pi, height)
    seam = np.arange(len(flat))
    seam[around :: around + 1] = seam[0 :: around + 1]
    used, faces = np.unique(seam[faces], return_inverse=True)
    flat, faces = flat[used], faces.reshape(-1, 3)
    angle = flat[:, 0]
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), flat[:, 1]]), faces


LIMBS = (  # bent limbs of different lengths and widths
    (((0, 0, 0), (0.9, 0.1, 0.0), (1.5, 0.7, 0.2), (1.7, 1.5, 0.3)), 0.24),
    (((0, 0, 0), (-0.8, 0.3, 0.1), (-1.5, -0.2, 0.3), (-2.2, 0.1, 0.9)), 0.27),
    (((0, 0, 0), (0.2, -0.9, 0.0), (0.3, -1.7, 0.5), (0.1, -2.2, 0.1)), 0.30),
    (((0, 0, 0), (0.0, 0.9, 0.3), (-0.2, 1.5, 0.9)), 0.33),
    (((0, 0, 0), (0.1, 0.0, 1.0), (0.5, -0.4, 1.7), (1.0, -0.4, 2.2)), 0.25),
)


def joint(degrees: float, along: int = 60, around: int = 24, length: float = 4.0, radius: float = 0.4) -> Mesh:
    """A closed limb with one joint in the middle, bent by an angle: a tube about straight, arc, straight."""
    arc = 1.0  # length of the bent part
    way = np.linspace(0, length, 20 * along)
    angle = np.clip(way - (length - arc) / 2, 0, arc) * np.deg2rad(degrees) / arc
    step = way[1]
    at = np.linspace(0, length, along)
    x = np.interp(at, way, np.cumsum(np.cos(angle)) * step)
    y = np.interp(at, way, np.cumsum(np.sin(angle)) * step)
    turn = np.interp(at, way, angle)
    round_ = np.linspace(0, 2 * np.pi, around, endpoint=False)
    out = radius * np.cos(round_)
    vertices = np.stack(
        [
            x[:, None] - np.sin(turn)[:, None] * out,
            y[:, None] + np.cos(turn)[:, None] * out,
            np.tile(radius * np.sin(round_), (along, 1)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    ring, next_ = np.arange(around), np.roll(np.arange(around), -1)
    low = np.arange(along - 1)[:, None] * around
    a, b, c, d = (each.ravel() for each in (low + ring, low + next_, low + around + next_, low + around + ring))
    last = (along - 1) * around
    first_cap, last_cap = len(vertices), len(vertices) + 1
    caps = [np.column_stack([np.full(around, first_cap), next_, ring])]
    caps.append(np.column_stack([np.full(around, last_cap), last + ring, last + next_]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d]), *caps])
    return np.vstack([vertices, [[x[0], y[0], 0], [x[-1], y[-1], 0]]]), faces


def figure(cells: int = 24) -> Mesh:
    """A closed figure of five bent limbs."""
    return limbed(LIMBS, np.array([-2.8, -2.8, -1.0]), np.array([2.3, 2.1, 2.8]), cells)


def limbed(limbs: Sequence[Limb], low: np.ndarray, high: np.ndarray, cells: int) -> Mesh:
    """A closed body of limbs in a box: the level set of a sum of falling distances, on a grid of tetrahedra."""
    count = np.ceil((high - low) / (high - low).max() * cells).astype(int)
    axes = [np.linspace(low[i], high[i], count[i] + 1) for i in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    field = np.zeros(len(points))
    for line, width in limbs:
        stops = np.array(line, dtype=float)
        nearest = np.full(len(points), np.inf)
        for start, end in pairwise(stops):
            along = np.clip((points - start) @ (end - start) / np.sum((end - start) ** 2), 0, 1)
            nearest = np.minimum(nearest, np.linalg.norm(points - start - along[:, None] * (end - start), axis=1))
        field += np.exp(-((nearest / width) ** 2))
    return level_set(points, field - 0.37, count + 1)


def level_set(points: np.ndarray, field: np.ndarray, shape: Sequence[int]) -> Mesh:
    """Triangulate field = 0 over a box grid, each box cut into six tetrahedra; the inside has field > 0."""
    _, ny, nz = shape
    start = np.stack(np.meshgrid(*(np.arange(s - 1) for s in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    box = lambda i, j, k: ((start[:, 0] + i) * ny + start[:, 1] + j) * nz + start[:, 2] + k  # noqa: E731
    paths = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    cuts = []
    for path in paths:
        step, corners = [0, 0, 0], [box(0, 0, 0)]
        for axis in path:
            step[axis] = 1
            corners.append(box(*step))
        cuts.append(np.stack(corners, axis=1))
    tetrahedra = np.concatenate(cuts)
    inside = field[tetrahedra] > 0
    found = []
    for number in range(1, 15):
        chosen = [bool(number >> corner & 1) for corner in range(4)]
        here = tetrahedra[(inside == chosen).all(axis=1)]
        into = [c for c in range(4) if chosen[c]]
        out = [c for c in range(4) if not chosen[c]]
        if len(into) == 2:
            (a, b), (c, d) = into, out
            ring = [(a, c), (a, d), (b, d), (b, c)]
            triangles = [ring[:3], [ring[0], *ring[2:]]]
        else:
            one, rest = (into[0], out) if len(into) == 1 else (out[0], into)
            triangles = [[(one, other) for other in rest]]
        for triangle in triangles:
            found.append(np.stack([np.sort(here[:, side], axis=1) for side in map(list, triangle)], axis=1))
    pairs = np.concatenate(found)  # (m, 3 corners, 2 ends)
    ends, number = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    share = field[ends[:, 0]] / (field[ends[:, 0]] - field[ends[:, 1]])
    share = np.clip(share, 0.1, 0.9)[:, None]  # no triangle much thinner than the grid
    vertices = points[ends[:, 0]] * (1 - share) + points[ends[:, 1]] * share
    faces = number.reshape(-1, 3)
    normal = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    falling = field[ends[number.reshape(-1, 3)[:, 0]]]  # field at the ends of the first corner's edge
    outward = np.where(falling[:, :1] > 0, 1, -1) * (points[ends[faces[:, 0], 1]] - points[ends[faces[:, 0], 0]])
    wrong = np.einsum("ij,ij->i", normal, outward) < 0
    faces[wrong] = faces[wrong][:, ::-1]
    return vertices, faces


def cut_along_seams(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    """Cut a figure along seams, as a .glb stores it: quadrants with borders of their own."""
    middle = vertices[faces].mean(axis=1)
    quadrant = 2 * (middle[:, 0] > 0) + (middle[:, 2] > 1)
    points, corners, first = [], [], 0
    for number in range(4):
        used, own = np.unique(faces[quadrant == number], return_inverse=True)
        points.append(vertices[used])
        corners.append(first + own.reshape(-1, 3))
        first += len(used)
    return np.concatenate(points), np.concatenate(corners)


def bent_tube() -> Mesh:
    """A closed tube bent by half a turn."""
    rings, around = 60, 12
    angle = np.linspace(0, np.pi, rings)
    turn = np.arange(around) * 2 * np.pi / around
    wide = 0.15 * np.sqrt(np.sin(np.linspace(0.05, np.pi - 0.05, rings)))
    out = 1 + wide[:, None] * np.cos(turn)
    vertices = np.stack(
        [out * np.cos(angle)[:, None], out * np.sin(angle)[:, None], wide[:, None] * np.sin(turn)], axis=2
    ).reshape(-1, 3)
    place = np.arange(rings * around).reshape(rings, around)
    right = np.roll(place, -1, axis=1)
    quads = np.stack([place[:-1], right[:-1], right[1:], place[1:]], axis=2).reshape(-1, 4)
    caps = [[place[0, 0], place[0, k + 1], place[0, k]] for k in range(1, around - 1)]
    caps += [[place[-1, 0], place[-1, k], place[-1, k + 1]] for k in range(1, around - 1)]
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], np.array(caps)])


def permuted(vertices: np.ndarray, faces: np.ndarray, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same mesh under other numbers; also the old number of every new vertex."""
    rng = np.random.default_rng(seed)
    old = rng.permutation(len(vertices))
    new = np.argsort(old)
    return vertices[old], new[faces][rng.permutation(len(faces))], old


def prepared(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, Triangulation]:
    """Scale a mesh to unit area; also its Delaunay triangulation."""
    from addon.core.mesh.geometry import surface_area
    from addon.core.surface.delaunay import intrinsic_delaunay
    from addon.core.surface.triangulation import triangulated

    points = (vertices - vertices.mean(axis=0)) / np.sqrt(surface_area(vertices, faces))
    return points, intrinsic_delaunay(triangulated(points, faces))


def read_obj(path: Path) -> Mesh:
    """Positions and triangles of a Wavefront file."""
    vertices, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:4]])
    return np.array(vertices), np.array(faces)


def write_off(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Write an .off file, and the folders it is in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [f"{x:.9g} {y:.9g} {z:.9g}" for x, y, z in np.asarray(vertices).tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in np.asarray(faces).tolist()]
    path.write_text("\n".join(lines) + "\n")


def write_obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Write an .obj file, and the folders it is in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in np.asarray(vertices).tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in np.asarray(faces).tolist()]
    path.write_text("\n".join(lines) + "\n")


def poses_of(folder: Path) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Names, positions and triangles of the .obj files of a folder, the rest pose first."""
    paths = sorted(folder.glob("*.obj"), key=lambda path: (path.stem not in ("rest", "bind"), path.stem))
    return [(path.stem, *read_obj(path)) for path in paths]


def unit(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Positions centred and scaled to unit area."""
    from addon.core.mesh.geometry import surface_area

    vertices = vertices - vertices.mean(axis=0)
    return vertices / np.sqrt(surface_area(vertices, faces))
