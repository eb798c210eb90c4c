"""Which vertices and faces are joined: components, borders, seams, duplicates, orientation."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from .edges import EdgeTable


def component_labels(vertex_count: int, pairs: IntArray) -> IntArray:
    """Label the connected components of a graph.

    `vertex_count`: number of vertices n; `pairs` (e, 2); gives (n,).

    Examples
    --------
    >>> component_labels(4, np.array([[0, 2]])).tolist()
    [0, 1, 0, 2]
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(vertex_count, vertex_count))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def border_labels(faces: IntArray, edges: EdgeTable) -> IntArray:
    """Label the borders of a mesh.

    `faces` (m, 3); `edges`: their edges; gives (n,).

    Examples
    --------
    >>> from addon.core.mesh.edges import edge_table
    >>> two = np.array([[0, 1, 2], [3, 4, 5]])
    >>> border_labels(two, edge_table(two)).tolist()
    [0, 0, 0, 1, 1, 1]
    """
    alone = edges.alone
    pairs = np.column_stack([edges.tail[alone], edges.head[alone]])
    label = np.full(int(faces.max(initial=-1)) + 1, -1, dtype=np.int64)
    if len(pairs):
        vertices, ends = np.unique(pairs, return_inverse=True)
        label[vertices] = component_labels(len(vertices), ends.reshape(-1, 2))
    return label


def without_repeated_corners(faces: IntArray) -> IntArray:
    """Drop the triangles that name a vertex twice.

    `faces` (m, 3); gives (m', 3).

    Examples
    --------
    >>> without_repeated_corners(np.array([[0, 1, 2], [1, 1, 2]])).tolist()
    [[0, 1, 2]]
    """
    twice = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return faces[~twice] if twice.any() else faces


def without_duplicates(faces: IntArray) -> IntArray:
    """Keep the first of triangles with the same three vertices, whatever their order.

    `faces` (m, 3); gives (m', 3).

    Examples
    --------
    >>> without_duplicates(np.array([[0, 1, 2], [2, 1, 0], [1, 2, 3]])).tolist()
    [[0, 1, 2], [1, 2, 3]]
    """
    low, mid, high = np.sort(faces, axis=1).T.astype(np.uint64)
    with np.errstate(over="ignore"):
        mixed = low * np.uint64(0x9E3779B97F4A7C15) ^ mid * np.uint64(0xC2B2AE3D27D4EB4F) ^ high
    order = np.argsort(mixed, kind="stable")
    alike = np.flatnonzero(mixed[order][1:] == mixed[order][:-1])
    if not len(alike):
        return faces
    some = np.unique(order[np.concatenate([alike, alike + 1])])  # rising, so the first of each stays
    _, first = np.unique(np.sort(faces[some], axis=1), axis=0, return_index=True)
    keep = np.ones(len(faces), dtype=bool)
    keep[some] = False
    keep[some[first]] = True
    return faces[keep]


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
    representative = np.arange(len(points))
    alone = edges.alone
    if len(alone) < 2:
        return representative
    ends = np.stack([edges.tail[alone], edges.head[alone]])
    rim, place = np.unique(ends, return_inverse=True)
    _, site = np.unique(points[rim] + 0.0, axis=0, return_inverse=True)  # + 0.0: -0 is 0
    if site.max() + 1 == len(rim):
        return representative
    site = site.ravel()[place.ravel()].reshape(2, -1)
    swap = site[0] > site[1]
    site[:, swap], ends[:, swap] = site[::-1, swap], ends[::-1, swap]
    third = points[faces.ravel()[alone // 3 * 3 + (alone + 2) % 3]] + 0.0
    order = np.lexsort((alone, site[1], site[0]))
    site, ends, third = site[:, order], ends[:, order], third[order]
    new = np.concatenate([[True], (site[:, 1:] != site[:, :-1]).any(axis=0)])
    group = np.cumsum(new) - 1
    first = np.flatnonzero(new)[group]
    differs = np.bincount(group, (third != third[first]).any(axis=1)) > 0
    joined = (first != np.arange(len(group))) & differs[group] & (site[0] != site[1])
    pairs = np.column_stack([ends[:, first[joined]].ravel(), ends[:, joined].ravel()])
    if not len(pairs):
        return representative
    label = component_labels(len(points), pairs)
    _, lowest, back = np.unique(label, return_index=True, return_inverse=True)
    return lowest[back.ravel()].astype(np.int64)


def consistently_oriented(faces: IntArray, edges: EdgeTable) -> IntArray:
    """Flip as few triangles as possible so that neighbours across an edge agree; one-sided pieces stay.

    `faces` (m, 3); `edges`: their edges; gives (m, 3).

    Examples
    --------
    >>> from addon.core.mesh.edges import edge_table
    >>> strip = np.array([[0, 1, 2], [2, 1, 3], [2, 4, 3]])
    >>> consistently_oriented(strip, edge_table(strip)).tolist()
    [[0, 1, 2], [2, 1, 3], [3, 4, 2]]
    """
    start = edges.start[edges.count == 2]
    one, other = edges.order[start], edges.order[start + 1]
    disagree = edges.tail[one] == edges.tail[other]
    if not disagree.any():
        return faces
    m = len(faces)
    f, g = one // 3, other // 3
    # each triangle stands twice in the graph: f as it is, m + f turned over
    pairs = np.concatenate([np.column_stack([f, g + m * disagree]), np.column_stack([m + f, m + g - m * disagree])])
    label = component_labels(2 * m, pairs)
    as_is, over = label[:m], label[m:]
    kept = np.bincount(as_is, minlength=int(label.max()) + 1)
    turn = (kept[over] > kept[as_is]) | ((kept[over] == kept[as_is]) & (over < as_is))
    result = faces.copy()
    result[turn] = result[turn][:, ::-1]
    return result
