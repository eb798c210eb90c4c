"""The same shape with other triangles: finer, coarser, uniform, adaptive, quad-dominant, noisy."""

import numpy as np

from addon.core.mesh.coarsening import coarsened
from addon.core.mesh.edges import vertex_pairs
from addon.core.surface.triangulation import corner_lengths, triangulated
from tests.meshes.shapes import Mesh


def subdivided(vertices, faces) -> Mesh:
    """Split every triangle into four at the midpoints of its edges."""
    edges = vertex_pairs(faces)
    key = edges[:, 0] * len(vertices) + edges[:, 1]

    def middle(a, b):
        return len(vertices) + np.searchsorted(key, np.minimum(a, b) * len(vertices) + np.maximum(a, b))

    a, b, c = faces.T
    ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
    parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    return np.concatenate([vertices, vertices[edges].mean(axis=1)]), np.concatenate(
        [np.stack(p, axis=1) for p in parts]
    )


def resized(vertices, faces, count) -> Mesh:
    """Change a mesh to a given number of vertices by subdivision and removal of vertices."""
    while len(vertices) < count:
        vertices, faces = subdivided(vertices, faces)
    coarse = coarsened(vertices, faces, count)
    return vertices[coarse.kept], coarse.faces


def noisy(vertices, faces, amount=0.01, seed=0) -> Mesh:
    """Move every vertex at random, by an amount in the unit of the vertices but at most a fifth of the mean edge."""
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    move = np.random.default_rng(seed).normal(size=vertices.shape) * min(amount, 0.2 * edge)
    return vertices + move, faces


def uniform(vertices, faces) -> Mesh:
    """Make triangles uniform: subdivide, then remove vertices, mostly by edge length."""
    return resized(*subdivided(*subdivided(vertices, faces)), len(vertices))


def adaptive(vertices, faces) -> Mesh:
    """Refine one side and coarsen the other: edges at the top are eight times shorter than at the bottom."""
    for level in range(3):
        height = vertices[:, 1]
        low, high = height.min(), height.max()
        chosen = (height[faces].mean(axis=1) - low) / (high - low) > (0.6, 0.75, 0.88)[level]
        vertices, faces = _split_some(vertices, faces, chosen)
    return vertices, faces


def _split_some(vertices, faces, chosen) -> Mesh:
    """Split the chosen triangles into four and their neighbours as needed, so that no vertex lies on an edge."""
    edges = vertex_pairs(faces)
    key = edges[:, 0] * len(vertices) + edges[:, 1]

    def number(a, b):
        return np.searchsorted(key, np.minimum(a, b) * len(vertices) + np.maximum(a, b))

    a, b, c = faces.T
    sides = np.stack([number(a, b), number(b, c), number(c, a)], axis=1)
    cut = np.zeros(len(edges), dtype=bool)
    cut[sides[chosen]] = True
    place = np.full(len(edges), -1)
    place[cut] = len(vertices) + np.arange(cut.sum())
    out = []
    for face, side in zip(faces, place[sides], strict=True):
        polygon = [
            p for corner, mid in zip(face, side, strict=True) for p in ((corner, mid) if mid >= 0 else (corner,))
        ]
        while len(polygon) > 3:  # cut off a corner between two midpoints, or any other
            at = next((i for i in range(len(polygon)) if polygon[i] in face and polygon[i - 1] not in face
                       and polygon[(i + 1) % len(polygon)] not in face), 1)  # fmt: skip
            out.append((polygon[at - 1], polygon[at], polygon[(at + 1) % len(polygon)]))
            polygon.pop(at)
        out.append(tuple(polygon))
    return np.concatenate([vertices, vertices[edges[cut]].mean(axis=1)]), np.array(out)


def quad_dominant(vertices, faces) -> Mesh:
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
