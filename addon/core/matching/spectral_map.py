"""The map between two surfaces: from forms and distances first, then between more and more eigenfunctions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..measures.alignment import rigid_fit
from ..mesh.closest_points import SurfacePoints, closest_around
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.nearest import nearest_rows
from ..numerics.products import product
from ..run.monitor import Monitor
from .proportions import in_proportion
from .starts import Start
from .unfolded import Unfolded

_NEAR, _FACING = 0.3, 0.08  # weights of position and normal relative to the distances from the feature points,
_SPECTRAL, _SIGNATURE = 0.2, 0.3  # of eigenfunctions and wave kernel signature
_TURNING = 4.0  # weight of normals times the number of eigenfunctions: normals find the trunk, eigenfunctions details
_EVERY = slice(None)


def first_map(
    one: Unfolded, other: Unfolded, start: Start, monitor: Monitor, *, rows: IntArray | slice = _EVERY
) -> IntArray:
    """Map each vertex to the most similar one in position, normal and distances from the feature points.

    `one, other`: the surfaces; `start`: the alignment of the forms, and the corresponding feature points; `rows`
    (r,); gives (r,).

    Examples
    --------
    >>> from addon.core.matching.unfolded import unfolded
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> first_map(body, body, Start(np.array([-1]), np.eye(3), np.zeros(3)), Monitor()).tolist()
    [0, 1, 2, 3]
    """
    known = np.flatnonzero(start.image >= 0)
    near, facing = (_NEAR, _FACING) if len(known) else (1.0, _FACING / _NEAR)
    here = [near * (one.form @ start.rotation + start.shift), facing * one.normals @ start.rotation]
    there = [near * other.form, facing * other.normals]
    image = start.image[known]
    lengths, other_lengths = one.limbs.distances[np.ix_(known, known)], other.limbs.distances[np.ix_(image, image)]
    own = in_proportion(one.limbs.to_features[:, known], lengths, other_lengths)
    others = other.limbs.to_features[:, image]
    return nearest_rows(np.column_stack([own, *here])[rows], np.column_stack([others, *there]), monitor)


def refined(
    one: Unfolded,
    other: Unfolded,
    partner: IntArray,
    counts: Sequence[int],
    near: float,
    monitor: Monitor,
    *,
    facing: float | None = None,
    rows: IntArray | None = None,
) -> IntArray:
    """Refine a map between vertices through maps between eigenfunctions.

    Each round uses more of them. Those of the other surface are expressed in those of this one, which regularises the
    map. Positions and normals of the forms distinguish left from right; this form moves smoothly to the other.

    `one, other`: the surfaces; `partner` (r,); `counts`: numbers of eigenfunctions, round by round; `near`: weight of
    positions on the form; `facing`: weight of normals, by default lower with more eigenfunctions; `rows` (r,); gives
    (r,).

    Examples
    --------
    >>> from addon.core.matching.unfolded import unfolded
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> refined(body, body, np.arange(4), (2, 3), 0.3, Monitor()).tolist()
    [0, 1, 2, 3]

    References
    ----------
    Melzi and others, "ZoomOut: Spectral Upsampling for Efficient Shape Correspondence", 2019,
    doi:10.1145/3355089.3356524; the forms with the eigenfunctions: Eisenberger, Lähner and Cremers, "Smooth Shells",
    2020, doi:10.1109/CVPR42600.2020.01228.
    """
    for count in counts:
        here, there = _side_by_side(one, other, partner, count, near, facing, rows)
        partner = nearest_rows(here, there, monitor)
    return partner


def on_triangles(
    one: Unfolded, other: Unfolded, partner: IntArray, count: int, near: float, monitor: Monitor
) -> SurfacePoints:
    """Refine a map once more, to points on the triangles of the other surface.

    `count`: number of eigenfunctions.

    Examples
    --------
    >>> from addon.core.matching.unfolded import unfolded
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> points = on_triangles(body, body, np.arange(4), 3, 0.3, Monitor())
    >>> points.nearest_corners(body.faces).tolist()
    [0, 1, 2, 3]
    """
    here, there = _side_by_side(one, other, partner, count, near, None, None)
    return closest_around(there, other.faces, here, nearest_rows(here, there, monitor))


def _side_by_side(
    one: Unfolded,
    other: Unfolded,
    partner: IntArray,
    count: int,
    near: float,
    facing: float | None,
    rows: IntArray | None,
) -> tuple[FloatArray, FloatArray]:
    """Stack eigenfunctions, positions and normals of both surfaces, made comparable by a map."""
    at: IntArray | slice = _EVERY if rows is None else rows
    waves, others = one.eigenvectors[at, :count], other.eigenvectors[:, :count]
    weights = one.areas if rows is None else np.full(len(rows), 1 / len(rows))
    weighted = (waves * weights[:, None]).T
    between = product(weighted, others[partner])  # C, (K, K')
    if rows is not None:  # on a sample the eigenfunctions are not orthonormal
        between = np.linalg.lstsq(product(weighted, waves), between, rcond=None)[0]
    rotation, shift = rigid_fit(one.form[at], other.form[partner], weights)
    placed = one.form[at] @ rotation + shift
    wide = slice(0, count // 2)
    way = weighted[wide] @ (other.form[partner] - placed)  # smooth: where the forms differ, one is moved to the other
    facing = _TURNING / count if facing is None else facing
    scale = _SPECTRAL / np.sqrt(max(waves.shape[1], others.shape[1]))
    moved, turned = placed + waves[:, wide] @ way, one.normals[at] @ rotation
    spanned = scale * product(others, between.T)
    return (
        np.column_stack([scale * waves, near * moved, facing * turned, _SIGNATURE * one.signature[at]]),
        np.column_stack([spanned, near * other.form, facing * other.normals, _SIGNATURE * other.signature]),
    )
