"""Bridges between the parts of a body: thin triangles at the joints of the parts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..mesh.connectivity import border_labels, component_labels
from ..mesh.edges import edge_table, vertex_pairs
from ..mesh.geometry import vertex_normals
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from .contacts import box_gaps
from .roles import AROUND, TOUCH, WIDEST_GAP

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_SHORT_WAY = 0.25  # path on the surface, in sqrt(area), beyond twice the link, up to which more contacts are bridged
_BORDER = 4.0  # weight of a border vertex, relative to an inner one: joints are where surfaces end
_HELD, _HELD_FACTOR = 0.7, 10.0  # share of an open end in a contact above which it is held, and the factor for that
_FEW = 8  # vertices of a contact below which its normals say little about how far around it is
_GAP = 0.01  # of a contact, at which its score is halved
_LINKED = 3  # vertices of the other part that a vertex is linked to: a single one would let a part twist
_FALLBACK = 3  # links between parts that no contact joins


class _Contact(NamedTuple):
    """Links between two parts that are adjacent on both."""

    links: IntArray
    lengths: FloatArray
    around: float
    score: float


def bridges_between(points: FloatArray, faces: IntArray, part: IntArray, surfaces: Sequence[FloatArray]) -> IntArray:
    """Compute triangles that join the parts of a body at their joints.

    Every vertex near another part is linked to the nearest vertices there; adjacent links form one contact. The
    contacts that hold best, from all around and along borders, join the parts. Others are bridged only if they shorten
    a path that is short already: two sides of one joint, but not a hand on a hip.

    `points` (c, 3); `faces` (d, 3); `part` (c,); `surfaces`: points spread densely over each part; gives (b, 3).

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [0.7, 0, 0], [0, 0.7, 0]])
    >>> points = np.concatenate([corners, corners + [0, 0, 0.01]])
    >>> faces, part = np.array([[0, 1, 2], [3, 4, 5]]), np.repeat([0, 1], 3)
    >>> bridges_between(points, faces, part, [points[:3], points[3:]]).shape
    (12, 3)
    """
    pairs = vertex_pairs(faces)
    normals = vertex_normals(points, faces)
    loop = _open_ends(points, border_labels(faces, edge_table(faces)))
    contacts = _contacts(points, pairs, normals, loop, part, surfaces)
    links = _chosen(points, pairs, part, contacts)
    return _triangles(points, pairs, links)


def _open_ends(points: FloatArray, loop: IntArray) -> IntArray:
    """Leave out borders no wider than what counts as touching: holes, through which nothing can be held."""
    kept = loop.copy()
    for index in range(int(loop.max(initial=-1)) + 1):
        if np.linalg.norm(np.ptp(points[loop == index], axis=0)) < TOUCH:
            kept[loop == index] = -1
    return kept


def _contacts(
    points: FloatArray,
    pairs: IntArray,
    normals: FloatArray,
    loop: IntArray,
    part: IntArray,
    surfaces: Sequence[FloatArray],
) -> list[_Contact]:
    """Link the parts where they are close, and group the links into contacts, the best first."""
    near = _within_two_edges(len(points), pairs)
    links, lengths = _links(points, near, part, surfaces)
    if not len(links):
        return []
    label = component_labels(len(links), _side_by_side(links, near))
    whole = np.bincount(loop[loop >= 0], minlength=1)
    label = _rings_closed(links, label, loop, whole, part)
    found = []
    for index in range(int(label.max()) + 1):
        here = label == index
        own, length = links[here], lengths[here]
        ends = [np.unique(side) for side in own.T]
        around = [1 - float(np.linalg.norm(normals[end].mean(axis=0))) for end in ends]
        count = [len(end) + _BORDER * np.count_nonzero(loop[end] >= 0) for end in ends]
        held = any((_shares(loop[end], whole) >= _HELD).any() for end in ends)
        factor = (_HELD_FACTOR if held else 1.0) / (1 + (length.min() / _GAP) ** 2)
        # both sides count: a hand on a hip is thin and has normals all around, but the hip has not
        score = float(min(count) / (min(count) + _FEW) * np.prod(around) * factor)
        found.append(_Contact(own, length, max(around), score))
    return sorted(found, key=lambda contact: -contact.score)


def _links(
    points: FloatArray, near: csr_matrix, part: IntArray, surfaces: Sequence[FloatArray]
) -> tuple[IntArray, FloatArray]:
    """Link every vertex near another part to the nearest vertices there; return links and distances from the parts."""
    from scipy.spatial import KDTree

    members = [np.flatnonzero(part == index) for index in range(len(surfaces))]
    dense = [KDTree(surface) for surface in surfaces]
    coarse = [KDTree(points[own]) for own in members]
    boxes = np.array([[surface.min(axis=0), surface.max(axis=0)] for surface in surfaces])
    found = []
    for i, own in enumerate(members):
        apart = box_gaps(boxes, np.array([points[own].min(axis=0), points[own].max(axis=0)]))
        for j in np.flatnonzero(apart <= WIDEST_GAP).tolist():
            if i == j:
                continue
            others = members[j]
            distance, at = dense[j].query(points[own], distance_upper_bound=WIDEST_GAP + TOUCH)
            if not np.isfinite(distance).any() or distance.min() > WIDEST_GAP:
                continue
            here = np.flatnonzero(distance < max(TOUCH, distance.min() + TOUCH / 2))
            count = min(_LINKED, len(others))
            there = others[coarse[j].query(surfaces[j][at[here]], k=count)[1].reshape(len(here), -1)]
            here, first, there = np.repeat(here, count), np.repeat(there[:, 0], count), there.ravel()
            beside = np.asarray(near[first, there]).ravel() > 0  # not on another limb that is as near
            here = here[beside]
            ends = np.column_stack([own[here], there[beside]])
            found.append(np.column_stack([ends if i < j else ends[:, ::-1], distance[here]]))
    if not found:
        return np.empty((0, 2), dtype=np.int64), np.empty(0)
    every = np.concatenate(found)
    every = every[np.lexsort((every[:, 2], every[:, 1], every[:, 0]))]
    ends = every[:, :2].astype(np.int64)
    new = np.concatenate([[True], (ends[1:] != ends[:-1]).any(axis=1)])
    return ends[new], every[new, 2]


def _within_two_edges(count: int, pairs: IntArray) -> csr_matrix:
    """Mark the vertices that are within two edges of each other, or the same."""
    from scipy.sparse import coo_matrix, identity

    one = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count)).tocsr()
    one = one + one.T + identity(count, format="csr")
    return one @ one


def _rings_closed(links: IntArray, label: IntArray, loop: IntArray, whole: IntArray, part: IntArray) -> IntArray:
    """Merge contacts that hold an open end only together, such as the front and the back of a neck."""
    ends = np.concatenate([links[:, 0], links[:, 1]])
    others = np.concatenate([part[links[:, 1]], part[links[:, 0]]])
    labels = np.tile(label, 2)
    on_border = loop[ends] >= 0
    rows = np.unique(np.column_stack([loop[ends], others, labels, ends])[on_border], axis=0)  # each vertex once
    held, count = np.unique(rows[:, [0, 2]], axis=0, return_counts=True)
    alone = np.unique(held[count >= _HELD * whole[held[:, 0]], 1])  # contacts that hold an open end
    rows = rows[~np.isin(rows[:, 2], alone)]
    together = []
    for ring, other in np.unique(rows[:, :2], axis=0):
        here = rows[(rows[:, 0] == ring) & (rows[:, 1] == other)]
        if len(np.unique(here[:, 3])) >= _HELD * whole[ring]:
            own = np.unique(here[:, 2])
            together.append(np.column_stack([own[:-1], own[1:]]))
    if not together:
        return label
    merged: IntArray = component_labels(int(label.max()) + 1, np.concatenate(together))[label]
    return merged


def _side_by_side(links: IntArray, near: csr_matrix) -> IntArray:
    """List the pairs of links whose ends are near each other on both parts."""
    from scipy.sparse import csr_matrix

    def of_links(end: IntArray) -> csr_matrix:
        chosen = csr_matrix((np.ones(len(end)), end, np.arange(len(end) + 1)), shape=(len(end), near.shape[0]))
        between = chosen @ near @ chosen.T
        between.data[:] = 1.0
        return between

    both = of_links(links[:, 0]).multiply(of_links(links[:, 1])).tocoo()
    return np.column_stack([both.row, both.col])


def _chosen(points: FloatArray, pairs: IntArray, part: IntArray, contacts: list[_Contact]) -> IntArray:
    """Choose the contacts that join the parts, and those between places that are near each other by way of these."""
    joined = np.arange(int(part.max()) + 1)  # which parts are connected so far
    chosen: list[IntArray] = []
    others: list[_Contact] = []
    for contact in contacts:
        one, other = joined[part[contact.links[0]]]
        if one != other:
            joined[joined == other] = one
            chosen.append(contact.links)
        elif contact.around >= AROUND:
            others.append(contact)
    while (joined != joined[0]).any():
        chosen.append(_shortest_links(points, joined[part]))
        ends = part[chosen[-1][0]]
        joined[joined == joined[ends[1]]] = joined[ends[0]]
    if others:
        near = _ways_are_short(points, np.concatenate([pairs, *chosen]), others)
        chosen += [contact.links for contact, short in zip(others, near, strict=True) if short]
    return np.concatenate(chosen) if chosen else np.empty((0, 2), dtype=np.int64)


def _ways_are_short(points: FloatArray, edges: IntArray, contacts: list[_Contact]) -> BoolArray:
    """Check which contacts join places that are near each other along some edges."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra

    lengths = np.maximum(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1), 1e-9)
    graph = coo_matrix((lengths, (edges[:, 0], edges[:, 1])), shape=(len(points), len(points))).tocsr()
    start, end = np.array([contact.links[np.argmin(contact.lengths)] for contact in contacts]).T
    limit = _SHORT_WAY + 2 * np.linalg.norm(points[start] - points[end], axis=1)
    sources, row = np.unique(start, return_inverse=True)
    away = dijkstra(graph, directed=False, indices=sources, limit=float(limit.max()))
    return np.asarray(away[row.ravel(), end] <= limit)


def _shortest_links(points: FloatArray, group: IntArray) -> IntArray:
    """Link the first group of parts to the nearest other group by their shortest links."""
    from scipy.spatial import KDTree

    first, rest = np.flatnonzero(group == group[0]), np.flatnonzero(group != group[0])
    distance, at = KDTree(points[first]).query(points[rest])
    rest, at, distance = (each[group[rest] == group[rest[np.argmin(distance)]]] for each in (rest, at, distance))
    best = np.argsort(distance, kind="stable")[:_FALLBACK]
    return np.column_stack([first[at[best]], rest[best]])


def _triangles(points: FloatArray, pairs: IntArray, links: IntArray) -> IntArray:
    """Build two thin triangles per link: with the edge at either end that leads nearest to the other end."""
    if not len(links):
        return np.empty((0, 3), dtype=np.int64)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    first = np.searchsorted(both[:, 0], np.arange(len(points) + 1))
    made = []
    for start, end in (links.T, links.T[::-1]):
        degree = first[start + 1] - first[start]
        owner = np.repeat(np.arange(len(links)), degree)
        edge = first[start][owner] + np.arange(len(owner)) - np.repeat(np.cumsum(degree) - degree, degree)
        beside = both[edge, 1]
        away = np.linalg.norm(points[beside] - points[end[owner]], axis=1)
        order = np.lexsort((beside, away, owner))
        nearest = beside[order][np.searchsorted(owner, np.arange(len(links)))]
        made.append(np.column_stack([start, end, nearest]))
    triangles = np.concatenate(made)
    _, single = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    return triangles[np.sort(single)]


def _shares(loop: IntArray, whole: IntArray) -> FloatArray:
    """Compute the share of each border that some vertices make up."""
    return np.bincount(loop[loop >= 0], minlength=len(whole)) / np.maximum(whole, 1)
