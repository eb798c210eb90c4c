"""Mesh repair: seams closed, degenerate and duplicate faces left out, faces oriented consistently.

The user's mesh is never changed: this is the surface that the methods use. Every difference from the mesh is a warning.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import BoolArray, FloatArray, IntArray
from ..run.messages import Message, message
from ..run.monitor import Monitor
from .connectivity import repeats_a_corner, repeats_a_triangle, turned_over
from .edges import edge_table
from .geometry import checked_arrays, relative_rounding
from .seams import joined_at_seams

_COARSE = 1e-4  # share of the size below which rounding of the positions is not reported


class RepairedMesh(NamedTuple):
    """The surface in a mesh.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float64
        The positions, as given.
    faces : (m', 3) ndarray of int64
        Triangles of three different vertices each, without duplicates, oriented consistently where possible. Of
        coincident vertices along a seam they use the first.
    unjoined : (m', 3) ndarray of int64
        The same triangles with the vertices that the mesh as given has there: of coincident ones each its own.
    representative : (n,) ndarray of int64
        The vertex that each vertex is identified with: itself, or the first at its position.
    changes : dict of str to int
        Number of faces left out, vertices joined and faces flipped, by kind of message.
    rounding : float
        Rounding of the positions, as a share of the size.
    """

    vertices: FloatArray
    faces: IntArray
    unjoined: IntArray
    representative: IntArray
    changes: dict[str, int]
    rounding: float

    @property
    def warnings(self) -> list[Message]:
        """Every difference from the mesh as given."""
        found = [message(kind, count=count) for kind, count in self.changes.items() if count]
        return found if self.rounding < _COARSE else [*found, message("rounded_positions", share=self.rounding)]


def repaired(vertices: ArrayLike, faces: ArrayLike, monitor: Monitor | None = None) -> RepairedMesh:
    """Repair a mesh: find the surface in it.

    Faces that use a vertex twice and duplicate faces are left out. Where borders coincide, as along the seams that
    many file formats cut, their vertices are treated as one. Faces oriented opposite to their neighbours are
    flipped.

    `vertices` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> mesh = repaired([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [2, 1, 0], [0, 0, 1]])
    >>> [(each.kind, each.numbers["count"]) for each in mesh.warnings]
    [('repeated_corners', 1), ('duplicate_faces', 1)]
    """
    check = (monitor or Monitor()).check
    points, given = checked_arrays(vertices, faces)
    rounding = relative_rounding(points)
    check()
    repeated = repeats_a_corner(given)
    whole = given[~repeated] if repeated.any() else given
    edges = edge_table(whole)
    check()
    representative = joined_at_seams(points, whole, edges)
    check()
    joined = int(np.count_nonzero(representative != np.arange(len(points))))
    sewn = representative[whole] if joined else whole
    kept = ~repeats_a_corner(sewn) if joined else np.ones(len(whole), dtype=bool)
    doubled = repeats_a_triangle(sewn) & kept
    check()
    kept &= ~doubled
    same = kept.all()
    single, unjoined = (sewn, whole) if same else (sewn[kept], whole[kept])
    turned = turned_over(single, edges if single is whole else edge_table(single))
    changes = {
        "repeated_corners": len(given) - len(whole),
        "coincident_borders": joined,
        "duplicate_faces": int(np.count_nonzero(doubled)),
        "inconsistent_faces": int(np.count_nonzero(turned)),
    }
    oriented = _flipped(single, turned)
    cut = oriented if single is unjoined else _flipped(unjoined, turned)
    return RepairedMesh(points, oriented, cut, representative, changes, rounding)


def _flipped(faces: IntArray, turned: BoolArray) -> IntArray:
    """Turn some triangles over."""
    if not turned.any():
        return faces
    result = faces.copy()
    result[turned] = result[turned][:, ::-1]
    return result
