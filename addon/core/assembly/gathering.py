"""The results of the bodies combined on the mesh: values, shapes and features."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..mesh.geometry import of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .bodies import Bodies
from .strays import followed

if TYPE_CHECKING:
    from ..method_api.surface_features import WholeFeatures
    from ..symmetry.limbs import BodyLimbs


class GatheredFeatures(NamedTuple):
    """Feature points and patches of all bodies of a mesh.

    Attributes
    ----------
    points : (k,) ndarray of int
        Vertices of the mesh: those chosen by hand in their order, then the others, body by body.
    patches : (n,) ndarray of int
        Patch of every vertex; -1 for vertices of no piece.
    adf : (n,) ndarray of float
        Auto Diffusion Function of every vertex; 0 for vertices of no piece.
    bodies : list of BodyLimbs
        The limbs identified among the feature points of each body.
    """

    points: IntArray
    patches: IntArray
    adf: FloatArray
    bodies: list[BodyLimbs]

    def numbered(self, values: Sequence[Sequence[str]]) -> list[str]:
        """Sort texts of the feature points of each body by their numbers."""
        found = [""] * len(self.points)
        for body, own in zip(self.bodies, values, strict=True):
            for number, value in zip(body.numbers, own, strict=True):
                found[number] = value
        return found


def gathered(bodies: Bodies, values: Sequence[np.ndarray], others: np.ndarray) -> np.ndarray:
    """Gather values of the bodies on all vertices of the mesh.

    `bodies`: the bodies; `values`: values on the vertices of each body's surface; `others` (n, ...); gives (n, ...).

    Examples
    --------
    >>> from addon.core.assembly.bodies import bodies_of
    >>> bodies = bodies_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], [[0, 1, 2]])
    >>> gathered(bodies, [np.array([7, 8, 9])], np.full(4, -1)).tolist()
    [7, 8, 9, -1]
    """
    whole = others.copy()
    for body, each in zip(bodies.bodies, values, strict=True):
        whole[body.vertices] = each
        for rider in body.riders:
            whole[rider.piece.vertices] = each[rider.carriers]
    return _with_copies(bodies, whole)


def shaped(bodies: Bodies, shapes: Sequence[FloatArray], monitor: Monitor, *, area_kept: bool = False) -> FloatArray:
    """Gather the shapes of the bodies; riders follow the surface under them.

    `bodies`: the bodies; `shapes`: positions of the vertices of each body's surface; `area_kept`: whether a body with
    riders is scaled to the area that it has in the mesh; gives (n, 3).

    Examples
    --------
    >>> from addon.core.assembly.bodies import bodies_of
    >>> bodies = bodies_of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> np.array_equal(shaped(bodies, [bodies.bodies[0].points], Monitor()), bodies.vertices)
    True
    """
    whole = bodies.vertices.copy()
    for body, each in zip(bodies.bodies, shapes, strict=True):
        whole[body.vertices] = each
        for rider, shape in zip(body.riders, body.with_riders(each, monitor), strict=True):
            whole[rider.piece.vertices] = shape
        if area_kept and body.riders:
            used, corners = np.unique(body.all_faces, return_inverse=True)  # loose vertices may be far away
            corners = corners.reshape(-1, 3)
            surfaces = bodies.pieces.drawn_in, whole
            before, after = (of_unit_area(points[used], corners)[2] for points in surfaces)
            centre = whole[used].mean(axis=0)
            whole[used] = centre + (whole[used] - centre) * (before / after)
    strays = bodies.pieces.strays
    if len(strays):
        whole[strays] = followed(bodies.vertices, whole, bodies.faces, strays)
    return _with_copies(bodies, whole)


def gathered_features(bodies: Bodies, found: Sequence[WholeFeatures]) -> GatheredFeatures:
    """Gather the features of the bodies on the whole mesh.

    `bodies`: the bodies; `found`: the features of each.

    Examples
    --------
    >>> from addon.core import feature_patches
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> found = feature_patches(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> found.bodies[0].vertices.tolist()
    [0, 1, 2, 3]
    """
    from ..symmetry.limbs import BodyLimbs

    count = len(bodies.vertices)
    numbers = feature_numbers(bodies, [each.points for each in found])
    points = np.empty(sum(map(len, numbers)), dtype=np.int64)
    for body, number, each in zip(bodies.bodies, numbers, found, strict=True):
        points[number] = body.vertices[each.points]
    if bodies.given is not None:
        points[: len(bodies.given)] = bodies.given  # which may be copies, along a seam, or on riders
    cells = [number[each.cells] for number, each in zip(numbers, found, strict=True)]
    return GatheredFeatures(
        points,
        gathered(bodies, cells, np.full(count, -1)),
        gathered(bodies, [each.adf for each in found], np.zeros(count)),
        [
            BodyLimbs(body.vertices, each.points, number, each.limbs)
            for body, each, number in zip(bodies.bodies, found, numbers, strict=True)
        ],
    )


def feature_numbers(bodies: Bodies, features: Sequence[IntArray]) -> list[IntArray]:
    """Assign numbers to the feature points of the bodies: those chosen by hand in their order, then body by body.

    `bodies`: the bodies; `features`: feature points of each.

    Examples
    --------
    >>> from addon.core.assembly.bodies import bodies_of
    >>> bodies = bodies_of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> [numbers.tolist() for numbers in feature_numbers(bodies, [np.array([2, 0])])]
    [[0, 1]]
    """
    first = np.cumsum([0, *map(len, features)])
    place = [
        len(bodies.vertices) + start + np.arange(len(each)) if chosen is None else chosen.positions
        for start, each, chosen in zip(first[:-1], features, bodies.chosen, strict=True)
    ]
    number = np.empty(first[-1], dtype=np.int64)
    number[np.argsort(np.concatenate(place), kind="stable")] = np.arange(first[-1])
    return [number[start:end] for start, end in pairwise(first)]


def _with_copies(bodies: Bodies, whole: np.ndarray) -> np.ndarray:
    """Assign the same values to vertices that were treated as one."""
    representative = bodies.pieces.representative
    copies = np.flatnonzero(representative != np.arange(len(whole)))
    whole[copies] = whole[representative[copies]]
    return whole
