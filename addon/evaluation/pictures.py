"""Draws meshes without a renderer: points on the surface, the nearest one in each pixel, the inside in red."""

from __future__ import annotations

import numpy as np

from ..core.mesh.geometry import area_vectors, weights_on_triangle
from ..core.numerics.arrays import FloatArray, IntArray

_POINTS_A_PIXEL = 16
_OUTSIDE, _INSIDE = np.array([205.0, 205.0, 212.0]), np.array([220.0, 60.0, 60.0])
_LIGHT = np.array([0.3, 0.4, 0.87])


def drawn(
    vertices: FloatArray,
    faces: IntArray,
    turn: FloatArray | None = None,
    size: int = 190,
    colours: FloatArray | None = None,
    extent: float | None = None,
) -> np.ndarray:
    """Draw one mesh, seen along the third axis.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.
    turn : (3, 3) ndarray of float, optional
        Rotation before drawing, ``x ↦ x R``.
    size : int
        Width and height in pixels.
    colours : (n, 3) ndarray of float, optional
        Colour of every vertex, 0 to 255, for the outer side of the surface.
    extent : float, optional
        Length that fills the picture; that of the mesh if omitted.

    Returns
    -------
    (size, size, 3) ndarray of uint8
        The picture, with a white background.
    """
    if turn is not None:
        vertices = vertices @ turn
    normal = area_vectors(vertices, faces)
    area = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(area, 1e-300)[:, None]
    reached = np.cumsum(area) / area.sum() * _POINTS_A_PIXEL * size * size
    face = np.repeat(np.arange(len(faces)), np.diff(np.rint(reached).astype(np.int64), prepend=0))
    at = weights_on_triangle(*np.random.default_rng(0).random((2, len(face)))).T  # (3, p), of the corners
    x, y, z = (sum(at[k] * axis[faces[:, k]][face] for k in range(3)) for axis in vertices.T)
    wide = extent or max(np.ptp(x), np.ptp(y)) * 1.08
    column = np.clip(((x - (x.max() + x.min()) / 2) / wide + 0.5) * size, 0, size - 1).astype(np.int64)
    row = np.clip(((y.max() + y.min()) / 2 - y) / wide * size + 0.5 * size, 0, size - 1).astype(np.int64)
    nearest = np.full(size * size, -1)
    order = np.argsort(z, kind="stable")
    nearest[(row * size + column)[order]] = order  # the last stays
    hit = np.flatnonzero(nearest >= 0)
    seen = nearest[hit]
    face = face[seen]
    outside = _OUTSIDE if colours is None else np.einsum("kp,pkc->pc", at[:, seen], colours[faces[face]])
    shade = np.minimum(0.25 + 0.75 * np.abs(normal @ _LIGHT), 1.0)[face]
    image = np.full((size * size, 3), 255, np.uint8)
    image[hit] = (np.where(normal[face][:, 2:] > 0, outside, _INSIDE) * shade[:, None]).astype(np.uint8)
    return image.reshape(size, size, 3)


def upright(vertices: FloatArray) -> FloatArray:
    """Return a rotation that shows the widest view of a shape: longest axis up, shortest axis towards the viewer.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertices.

    Returns
    -------
    (3, 3) ndarray of float
        R, proper; ``x ↦ x R``.
    """
    axes = np.linalg.eigh(np.cov(vertices.T))[1]
    turn = axes[:, [1, 2, 0]]
    turn = turn * np.where(turn[np.abs(turn).argmax(axis=0), np.arange(3)] < 0, -1.0, 1.0)
    if np.linalg.det(turn) < 0:
        turn[:, 2] *= -1
    return turn
