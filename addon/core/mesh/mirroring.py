"""Half a mesh combined with its mirror images, and shapes of the whole made symmetric."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from .geometry import surface_area


class Mirror(NamedTuple):
    """A plane through the origin, across one of the axes.

    Attributes
    ----------
    axis : int
        0, 1 or 2.
    merge : float
        Distance up to which vertices are merged with their images; negative for none.
    """

    axis: int
    merge: float


class Mirrored(NamedTuple):
    """A mesh with its mirror images.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Positions; those of the half come first.
    faces : (m, 3) ndarray of int
        Triangles.
    source : (n,) ndarray of int
        The vertex of the half that each is an image of.
    images : list of (n,) ndarray of int
        For each mirror, the image of every vertex.
    mirrors : sequence of Mirror
        The mirrors.
    """

    vertices: FloatArray
    faces: IntArray
    source: IntArray
    images: list[IntArray]
    mirrors: Sequence[Mirror]

    @property
    def half(self) -> int:
        """Number of vertices of the half."""
        return int(self.source.max(initial=-1)) + 1

    def symmetrised(self, shape: FloatArray) -> FloatArray:
        """Make a shape symmetric in every mirror: the mean of the shape and its images.

        `shape` (n, 3); gives (n, 3).
        """
        for image, mirror in zip(self.images, self.mirrors, strict=True):
            shape = (shape + shape[image] * _signs(mirror)) / 2
        return shape

    def asymmetry(self, shape: FloatArray) -> float:
        """Measure the asymmetry of a shape. `shape` (n, 3)."""
        apart = shape - self.symmetrised(shape)
        return float(np.sqrt((apart**2).sum(axis=1).mean() / surface_area(self.vertices, self.faces)))

    def spread(self, shape: FloatArray) -> FloatArray:
        """Combine a shape of the half with its images. `shape` (h, 3); gives (n, 3)."""
        return mirrored(shape, self.faces[:0], self.mirrors, like=self).vertices


def mirrored(
    vertices: FloatArray, faces: IntArray, mirrors: Sequence[Mirror], *, like: Mirrored | None = None
) -> Mirrored:
    """Add the mirror images to a mesh, one mirror after the other.

    `vertices` (h, 3); `faces` (m, 3); `mirrors`: the mirrors, each across a different axis; `like`: merge the
    vertices that are merged there.

    Examples
    --------
    >>> half = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> whole = mirrored(half, np.array([[0, 1, 2]]), [Mirror(0, 1e-3)])
    >>> whole.vertices.tolist()[3:], whole.faces.tolist()
    ([[-1.0, 0.0, 0.0]], [[0, 1, 2], [2, 3, 0]])
    """
    source = np.arange(len(vertices))
    images: list[IntArray] = []
    for number, mirror in enumerate(mirrors):
        count = len(vertices)
        if like is None:
            own = 2 * np.abs(vertices[:, mirror.axis]) <= mirror.merge
        else:
            own = like.images[number][:count] == np.arange(count)
        copy = np.where(own, np.arange(count), count - 1 + np.cumsum(~own))
        images = [np.concatenate([image, copy[image][~own]]) for image in images]
        images.append(np.concatenate([copy, np.flatnonzero(~own)]))
        vertices = np.concatenate([vertices, (vertices * _signs(mirror))[~own]])
        faces = np.concatenate([faces, copy[faces][:, ::-1]])
        source = np.concatenate([source, source[~own]])
    return Mirrored(vertices, faces, source, images, mirrors)


def _signs(mirror: Mirror) -> FloatArray:
    """Return the factors of the coordinates."""
    signs = np.ones(3)
    signs[mirror.axis] = -1.0
    return signs
