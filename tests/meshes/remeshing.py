"""The same shape with other triangles: finer, coarser, uniform, adaptive, quad-dominant, noisy."""

import numpy as np

from addon.core.mesh.coarsening import coarsened
from addon.core.surface.triangulation import corner_lengths, triangulated
from tests.meshes.shapes import Mesh, midpoints


def resized(vertices: np.ndarray, faces: np.ndarray, count: int, fixed: np.ndarray | None = None) -> Mesh:
    """Change a mesh to a number of vertices by subdivision and removal of vertices, of which some may be fixed."""
    while len(vertices) < count:
        vertices, faces = midpoints(vertices, faces)
    coarse = coarsened(vertices, faces, count, fixed=fixed)
    return vertices[coarse.kept], coarse.faces


def uniform(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    """Make triangles uniform: subdivide twice, then remove vertices, mostly by edge length."""
    return resized(*midpoints(*midpoints(vertices, faces)), len(vertices))


def adaptive(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    """Refine the top and coarsen the rest: edges at the top are a quarter as long, below about twice as long."""
    finer, finer_faces = midpoints(*midpoints(vertices, faces))
    height = finer[:, 1]
    top = np.flatnonzero(height > height.min() + 0.8 * np.ptp(height))
    return resized(finer, finer_faces, len(top) + len(vertices) // 4, fixed=top)


def quad_dominant(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    """Make triangles of quads: pair triangles at their longest edges, split each quad along the other diagonal."""
    edge = triangulated(vertices, faces).edges.ravel()
    order = np.argsort(edge, kind="stable")
    beside = np.flatnonzero(edge[order][1:] == edge[order][:-1])
    twin = np.full(len(edge), -1)
    twin[order[beside]], twin[order[beside + 1]] = order[beside + 1], order[beside]
    longest = np.argmax(corner_lengths(vertices, faces), axis=1) + 3 * np.arange(len(faces))
    used = np.zeros(len(faces), dtype=bool)
    out = []
    for half in longest:
        other = twin[half]
        one, two = half // 3, other // 3
        if other < 0 or used[one] or used[two] or longest[two] != other:
            continue
        used[one] = used[two] = True
        c, a, b = np.roll(faces[one], -(half % 3))
        d = faces[two][other % 3]
        out += [(c, a, d), (c, d, b)]
    return vertices, np.concatenate([np.array(out).reshape(-1, 3), faces[~used]])


def noisy(vertices: np.ndarray, faces: np.ndarray, amount: float = np.inf) -> Mesh:
    """Move every vertex at random, by an amount in the unit of the vertices but at most a fifth of the mean edge."""
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    move = np.random.default_rng(0).normal(size=vertices.shape) * min(amount, 0.2 * edge)
    return vertices + move, faces
