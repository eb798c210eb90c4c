"""A figure made of pieces, as artists make characters: cut at the neck and wrists, dressed, with eyes and buttons."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from addon.core.mesh.geometry import surface_area, vertex_area_vectors

from . import shapes


@dataclass(frozen=True, eq=False)
class Pieced:
    """Pieces beside each other in one mesh.

    Attributes
    ----------
    vertices, faces : ndarray
        The mesh.
    pieces : dict of str to ndarray
        The vertices of each piece.
    source : (n,) ndarray of int
        The vertex of the uncut figure that each vertex was made from; -1 for those of balls.
    """

    vertices: np.ndarray
    faces: np.ndarray
    pieces: dict[str, np.ndarray]
    source: np.ndarray


def cut(vertices, faces, below: dict[str, np.ndarray]) -> Pieced:
    """Cut a mesh into pieces, a hair apart so that no seam is closed.

    Parameters
    ----------
    vertices, faces : ndarray
        The mesh.
    below : dict of str to (m,) ndarray of bool
        The triangles of each piece; those of none are the trunk.
    """
    rest = ~np.logical_or.reduce(list(below.values()))
    made, unit = _Made(), np.sqrt(surface_area(vertices, faces))
    for number, (name, own) in enumerate({"trunk": rest, **below}.items()):
        used, corners = np.unique(faces[own], return_inverse=True)
        made.add(name, vertices[used] + 1e-4 * number * unit, corners.reshape(-1, 3), used)
    return made.pieced()


def dressed(vertices, faces, pieced: Pieced, covered: np.ndarray) -> Pieced:
    """Put a shell over some triangles of the uncut mesh, a hundredth of its size away."""
    normals = vertex_area_vectors(vertices, faces)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    used, corners = np.unique(faces[covered], return_inverse=True)
    shell = vertices[used] + 0.01 * np.sqrt(surface_area(vertices, faces)) * normals[used]
    made = _Made(pieced)
    made.add("shirt", shell, corners.reshape(-1, 3), used)
    return made.pieced()


def with_ball(pieced: Pieced, name: str, centre: np.ndarray, radius: float) -> Pieced:
    """Add a ball: an eye in a head, a button on a shirt."""
    ball, faces = shapes.sphere(2)
    made = _Made(pieced)
    made.add(name, centre + radius * ball, faces, np.full(len(ball), -1))
    return made.pieced()


def character() -> tuple[np.ndarray, np.ndarray, Pieced]:
    """Make the figure of `shapes.figure` and the same with its head and a hand cut off, a shirt and an eye."""
    vertices, faces = shapes.figure()
    middle = vertices[faces].mean(axis=1)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    share = (middle - low) / (high - low)
    pieced = cut(vertices, faces, {"head": share[:, 2] > 0.85, "hand": (share[:, 0] > 0.85) & (share[:, 2] <= 0.85)})
    pieced = dressed(vertices, faces, pieced, (np.abs(share[:, 0] - 0.5) < 0.12) & (np.abs(share[:, 2] - 0.55) < 0.12))
    top = vertices[np.argmax(vertices[:, 2])]
    return vertices, faces, with_ball(pieced, "eye", top, 0.02 * float(np.sqrt(surface_area(vertices, faces))))


def with_scales(vertices, faces, count: int, height: float = 0.004) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Add small squares that stand off a surface on some of its triangles, and name the triangle under each."""
    rng = np.random.default_rng(3)
    under = rng.choice(len(faces), count, replace=False)
    size = np.sqrt(surface_area(vertices, faces))
    a, b, c = (vertices[faces[under, corner]] for corner in range(3))
    along = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    across = np.cross(normal, along)
    middle = (a + b + c) / 3 + height * size * normal
    square = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) * 0.004 * size
    points = middle[:, None] + square[:, :1] * along[:, None] + square[:, 1:] * across[:, None]
    own = np.arange(count)[:, None, None] * 4 + np.array([[0, 1, 3], [0, 3, 2]]) + len(vertices)
    return np.vstack([vertices, points.reshape(-1, 3)]), np.vstack([faces, own.reshape(-1, 3)]), under


class _Made:
    def __init__(self, start: Pieced | None = None) -> None:
        self._points = [] if start is None else [start.vertices]
        self._faces = [] if start is None else [start.faces]
        self._source = [] if start is None else [start.source]
        self._pieces = {} if start is None else dict(start.pieces)
        self._count = 0 if start is None else len(start.vertices)

    def add(self, name, points, faces, source) -> None:
        self._points.append(points)
        self._faces.append(faces + self._count)
        self._source.append(source)
        self._pieces[name] = np.arange(self._count, self._count + len(points))
        self._count += len(points)

    def pieced(self) -> Pieced:
        return Pieced(
            np.concatenate(self._points), np.concatenate(self._faces), self._pieces, np.concatenate(self._source)
        )
