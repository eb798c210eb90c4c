"""Triangles in which skin has grown together: their corners lie far apart on the body at rest."""

from __future__ import annotations

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import vertex_pairs
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from ..run.monitor import Monitor

# All lengths are in sqrt(area) of the body.
_STRONG, _WEAK = 0.12, 0.06  # jumps of the place at rest along an edge: one that begins a contact, one that is of it
_RATIO = (0.9, 1.7)  # the way round over the surface, over the jump: as long as that, if the skin has grown together
_FAR = 0.18  # least jump of a contact: thinner ones are folds, armpits, fingers
_REACHED = 0.8  # share of the edges whose ends are connected by a way round at all
_BESIDE, _BESIDE_REACHED = 0.65, 0.9  # the same next to a contact that is sure
_SAMPLES, _LEAST = 120, 6  # edges whose way round is measured, in all and of each contact
_MANY, _FEWEST = 20_000, 40  # vertices above which fewer are, and least of them then
_LONGEST = 3.0  # way round that is looked for


def contact_faces(points: FloatArray, faces: IntArray, places: FloatArray, monitor: Monitor) -> BoolArray:
    """Find the triangles in which skin has grown together.

    A triangle is a suspect if its corners lie apart on the body at rest. Wherever a fit is poor there are such. They
    are a contact only if the way from one side to the other over the surface, round all suspects, is about as long as
    the jump: on a body that is whole it is next to nothing, or as long as the edge.

    `points` (n, 3), `faces` (m, 3): of unit area; `places` (n, 3): of each vertex at rest, as `star_rest`; gives (m,).

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> contact_faces(corner, np.array([[0, 1, 2]]), corner * 0.01, Monitor()).tolist()
    [False]
    """
    sides = places[faces] - places[np.roll(faces, -1, axis=1)]
    jump = np.linalg.norm(sides, axis=2).max(axis=1)
    weak = np.flatnonzero(jump > _WEAK)
    found = np.zeros(len(faces), dtype=bool)
    if not (jump > _STRONG).any():
        return found
    pairs = np.concatenate([faces[weak][:, :2], faces[weak][:, 1:]])
    label = component_labels(len(points), pairs)  # of vertices: faces of one contact share some
    some, group = np.unique(label[faces[weak, 0]], return_inverse=True)
    strong = np.bincount(group, jump[weak] > _STRONG, len(some)) > 0
    kept = _confirmed(points, faces, places, np.where(strong, some, -1), label, monitor)
    found[weak] = kept[group]
    return found


def _confirmed(
    points: FloatArray, faces: IntArray, places: FloatArray, contacts: IntArray, label: IntArray, monitor: Monitor
) -> BoolArray:
    """Tell which suspects are contacts. `contacts` (c,): their labels, -1 for none; `label` (n,); gives (c,)."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra

    edges = vertex_pairs(faces)
    apart, long = (np.linalg.norm(each[edges[:, 0]] - each[edges[:, 1]], axis=1) for each in (places, points))
    near, size = apart <= _WEAK, (len(points), len(points))
    ways = coo_matrix((long[near], (edges[near, 0], edges[near, 1])), shape=size).tocsr()
    measures = np.zeros((len(contacts), 3))  # ratio, jump, share that is reached
    far = np.flatnonzero(apart > _STRONG)
    samples = max(_FEWEST, _SAMPLES * min(1.0, _MANY / len(points)))
    for number in np.flatnonzero(contacts >= 0):
        across = far[label[edges[far, 0]] == contacts[number]]
        if len(across) == 0:
            continue
        most = max(_LEAST, int(samples * len(across) / len(far)))
        across = across[np.unique(np.linspace(0, len(across) - 1, most).astype(int))]
        round_about = np.empty(len(across))
        for each, (start, end) in enumerate(edges[across]):
            monitor.check()
            round_about[each] = dijkstra(ways, directed=False, indices=int(start), limit=_LONGEST)[end]
        reached = np.isfinite(round_about)
        ratio = np.where(reached, round_about, 0.0) / apart[across]
        measures[number] = np.median(ratio), np.median(apart[across]), reached.mean()
    ratio, jump, share = measures.T
    low, high = _RATIO
    kept = (ratio >= low) & (ratio <= high) & (jump >= _FAR) & (share >= _REACHED)
    if kept.any():
        kept |= (ratio >= _BESIDE) & (ratio <= high) & (share >= _BESIDE_REACHED)
    return kept


def contacts_between(faces: IntArray, bones: IntArray) -> list[tuple[int, int]]:
    """Name the two bones on either side of each contact, largest first.

    `faces` (c, 3): the triangles of all contacts; `bones` (n,): the bone that holds each vertex.

    Examples
    --------
    >>> contacts_between(np.array([[0, 1, 2], [1, 2, 3], [4, 5, 6]]), np.array([7, 7, 9, 9, 2, 2, 2]))
    [(7, 9), (2, 2)]
    """
    if len(faces) == 0:
        return []
    label = component_labels(int(faces.max()) + 1, np.concatenate([faces[:, :2], faces[:, 1:]]))[faces[:, 0]]
    found = []
    for each in sorted(np.unique(label), key=lambda own: -int((label == own).sum())):
        own = np.unique(faces[label == each])
        count = np.bincount(bones[own])
        first = int(count.argmax())
        count[first] = 0
        found.append((first, int(count.argmax()) if count.any() else first))
    return [(min(pair), max(pair)) for pair in found]
