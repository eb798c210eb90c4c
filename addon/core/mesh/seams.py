"""Seams: where borders coincide, as many file formats cut them, their vertices are one.

Pieces grow together along their seams, first where just two borders meet. A piece that shares only a tiny part of its
border with another, as a cap of hair that touches the head along one edge, stays a piece.
"""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import BoolArray, FloatArray, IntArray
from .connectivity import component_labels
from .edges import EdgeTable

_SAME = 1e-6  # of the diagonal of all borders: border vertices nearer than that are at one place
_SHORT = 0.01  # of the median border edge: nor are they farther apart than that
_TINY = 0.1  # of the smaller border: pieces that share less of it are not joined


def joined_at_seams(points: FloatArray, faces: IntArray, edges: EdgeTable) -> IntArray:
    """Join vertices along border edges that coincide: map every vertex to the first at its place.

    Sheets that lie on each other all over are not joined: there the third corners lie on each other too.

    `points` (n, 3); `faces` (m, 3); `edges`: their edges; gives (n,).

    Examples
    --------
    >>> from addon.core.mesh.edges import edge_table
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> cut = np.array([[0, 1, 2], [3, 4, 5]])
    >>> joined_at_seams(square, cut, edge_table(cut)).tolist()
    [0, 1, 2, 1, 4, 2]
    """
    count = len(points)
    alone = edges.alone
    if len(alone) < 2:
        return np.arange(count)
    ends = np.stack([edges.tail[alone], edges.head[alone]])  # (2, b)
    length = np.linalg.norm(points[ends[0]] - points[ends[1]], axis=1)
    rim, place = np.unique(ends, return_inverse=True)
    near = min(_SAME * float(np.linalg.norm(np.ptp(points[rim], axis=0))), _SHORT * float(np.median(length)))
    site = _sites(points[rim], near)
    if site.max() + 1 == len(rim):
        return np.arange(count)
    site = site[place.ravel()].reshape(2, -1)
    swap = site[0] > site[1]
    site[:, swap], ends[:, swap] = site[::-1, swap], ends[::-1, swap]
    third = points[faces.ravel()[alone // 3 * 3 + (alone + 2) % 3]]
    order = np.lexsort((alone, site[1], site[0]))
    site, ends, third, length = site[:, order], ends[:, order], third[order], length[order]
    new = np.concatenate([[True], (site[:, 1:] != site[:, :-1]).any(axis=0)])
    group = np.cumsum(new) - 1  # of border edges at the same place
    first = np.flatnonzero(new)[group]
    differs = np.bincount(group, np.linalg.norm(third - third[first], axis=1) > near) > 0
    shared = differs[group] & (site[0] != site[1]) & (np.bincount(group)[group] > 1)
    if not shared.any():
        return np.arange(count)
    vertex_piece = component_labels(count, np.concatenate([faces[:, :2], faces[:, 1:]]))
    piece = vertex_piece[ends[0]]
    lonely = np.bincount(piece, np.where(shared, 0.0, length)).astype(np.float64)
    ends, group = ends[:, shared], group[shared]
    piece = _grown_together(piece[shared], lonely, group, length[shared])
    joined = _neighbours(piece, group)
    joined = joined[:, piece[joined[0]] == piece[joined[1]]]
    one, other = ends[:, joined[0]], ends[:, joined[1]]
    label = component_labels(count, np.column_stack([one.ravel(), other.ravel()]))
    _, lowest, back = np.unique(label, return_index=True, return_inverse=True)
    return lowest[back.ravel()].astype(np.int64)


def _sites(points: FloatArray, near: float) -> IntArray:
    """Give places numbers, the same to points (p, 3) that are at one; gives (p,)."""
    from scipy.spatial import cKDTree

    places, site = np.unique(points + 0.0, axis=0, return_inverse=True)  # + 0.0: -0 is 0
    close = cKDTree(places).query_pairs(near, output_type="ndarray")
    site = site.ravel().astype(np.int64)
    return component_labels(len(places), close)[site] if len(close) else site


def _grown_together(piece: IntArray, lonely: FloatArray, group: IntArray, length: FloatArray) -> IntArray:
    """Let pieces grow together that share more than a tiny part of what is left of the smaller one's border.

    First along seams of two edges: at one of three, two are the surface, and the third touches it. `piece`, `group`,
    `length` (b,): of border edges that share their place with others; `lonely` (p,): length of the other border edges
    of each piece; gives (b,), the pieces that these edges belong to then.
    """
    for some in (np.flatnonzero(np.bincount(group)[group] == 2), np.arange(len(group))):
        while True:
            one, other = some[_neighbours(piece[some], group[some])]
            across = piece[one] != piece[other]
            left = lonely + np.bincount(piece, np.where(_has_partner(piece, group), 0.0, length), len(lonely))
            left[left == 0] = np.inf  # closed without the other
            keys, link = np.unique((piece[one] * len(lonely) + piece[other])[across], return_inverse=True)
            ends = np.column_stack([keys // len(lonely), keys % len(lonely)])
            shared = np.bincount(link.ravel(), length[one][across], len(ends))
            firm = ends[shared >= _TINY * left[ends].min(axis=1)]
            if not len(firm):
                break
            label = component_labels(len(lonely), firm)
            piece, lonely = label[piece], np.bincount(label, lonely).astype(np.float64)
    return piece


def _neighbours(piece: IntArray, group: IntArray) -> IntArray:
    """Pair the border edges at each place, those of one piece first; gives (2, e)."""
    order = np.lexsort((piece, group))
    one, other = order[:-1], order[1:]
    return np.stack([one, other])[:, group[one] == group[other]]


def _has_partner(piece: IntArray, group: IntArray) -> BoolArray:
    """Tell which border edges share their place with another of the same piece."""
    one, other = _neighbours(piece, group)
    alike = piece[one] == piece[other]
    found = np.zeros(len(piece), dtype=bool)
    found[one[alike]] = found[other[alike]] = True
    return found
