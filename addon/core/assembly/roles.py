"""The roles of the pieces of a mesh: which are the body, and which ride on it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..mesh.connectivity import border_labels, component_labels
from ..mesh.edges import edge_table
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from .carriers import carriers
from .contacts import Contact, Samples
from .pieces import Piece

TOUCH = 0.02  # distance below which pieces touch, in sqrt(area) of all pieces, like all lengths here
WIDEST_GAP = 0.04  # gap across which pieces still hold each other
_COVERED = 0.75  # share of a piece on others above which it rides there, like a shirt on a body
_REACH, _REACHING_AREA = 0.15, 0.02  # least values for a part of the body: extent beyond what it touches, and area
_FROM_JOINT = 0.06  # least extent beyond a joint, which holds all around: a head on its neck
_STICK = 0.09  # area over squared length of a stick; an arm has .2
_HELD_AREA, _LOOP, _HELD_LOOP = 0.01, 6, 0.7  # of one in an open end: its area, edges of the end, share of them near
AROUND = 0.2  # least 1 - |mean normal| of a joint, which holds all around; contact on one side has less
_HOLDING = 0.02  # least share of the smaller of two pieces that touches at a joint: interlaced fingers have less
_SEAM = 0.1  # width of a cut over the size of the piece that was cut off
_TIGHT = 0.01  # gap up to which pieces that follow each other touch
_HANGING = 0.5  # share of the length of a piece that is far from what it hangs on; what lies along it has less
_SMALLER = 0.5  # area of a piece over that of a body, below which it belongs to that body


class Roles(NamedTuple):
    """The roles of the pieces of a mesh.

    Attributes
    ----------
    bodies : list of list of int
        The pieces that are unfolded together, those of each body by descending area.
    riders : list of (int, int)
        Pieces that ride, and the piece that carries each: part of a body, or a rider listed before.
    """

    bodies: list[list[int]]
    riders: list[tuple[int, int]]


def roles_of(
    pieces: Sequence[Piece],
    samples: Sequence[Samples],
    contacts: Mapping[tuple[int, int], Contact],
    *,
    one_body: bool = False,
) -> Roles:
    """Separate the pieces of bodies from those that ride on them.

    The largest piece is part of a body. So is, by descending area, every piece that extends far from what it touches,
    some way from a joint, or is held in an open end: a leg, a head on a neck, an arm in a sleeve; and so are pieces
    that reach far in a row: an arm in segments. Pieces that are covered or small, or lie along others, ride, but for
    those that join parts: the ball between two limbs of a doll.

    `pieces`: the pieces, largest area first, of unit area in total; `samples`: samples of each; `contacts`: the
    distances between them; `one_body`: whether they are known to be one, as what one rig moves, whatever holds them.

    Examples
    --------
    >>> from addon.core.assembly.contacts import contacts_between, sampled
    >>> from addon.core.run.monitor import Monitor
    >>> big = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
    >>> pieces = [Piece(np.arange(3), each, np.array([[0, 1, 2]])) for each in (big, big / 20 + [0.1, 0.1, 0.01])]
    >>> samples = [sampled(piece.points, piece.faces) for piece in pieces]
    >>> roles_of(pieces, samples, contacts_between(pieces, samples, Monitor()))
    Roles(bodies=[[0]], riders=[(1, 0)])
    """
    cast = _Cast(pieces, samples, contacts)
    hosts, others = _hosts(cast)
    between = _balls(cast, hosts, others)
    bodies, touching = ([sorted(hosts + between)], []) if one_body else _bodies(cast, hosts + between)
    inside = {piece for body in bodies for piece in body}
    return _with_riders(cast, bodies, sorted([piece for piece in others if piece not in inside] + touching))


@dataclass(frozen=True, eq=False)
class _Cast:
    """The pieces and the distances between them."""

    pieces: Sequence[Piece]
    samples: Sequence[Samples]
    contacts: Mapping[tuple[int, int], Contact]
    known_loops: dict[int, list[IntArray]] = field(default_factory=dict)
    known_holds: dict[tuple[int, int], bool] = field(default_factory=dict)

    def loops(self, piece: int) -> list[IntArray]:
        """List the borders of a piece that are long enough."""
        if piece not in self.known_loops:
            self.known_loops[piece] = _border_loops(self.pieces[piece].faces)
        return self.known_loops[piece]

    def hold(self, one: int, other: int) -> bool:
        """Check whether two pieces hold each other."""
        pair = min(one, other), max(one, other)
        if pair not in self.known_holds:
            self.known_holds[pair] = _hold(self, *pair)
        return self.known_holds[pair]

    def area(self, piece: int) -> float:
        return self.samples[piece].area / self.whole_area

    @cached_property
    def whole_area(self) -> float:
        return sum(each.area for each in self.samples)

    def distance(self, piece: int, others: Iterable[int]) -> FloatArray:
        """Measure the distance of every sample of a piece from some other pieces."""
        each = [self.contacts[piece, other].distances for other in others if (piece, other) in self.contacts]
        return np.min(each, axis=0) if each else np.full(len(self.samples[piece].points), np.inf)

    def gap(self, one: Sequence[int], others: Sequence[int]) -> float:
        """Measure the smallest distance between two groups of pieces."""
        return min(
            (self.contacts[i, j].gap for i in one for j in others if (i, j) in self.contacts), default=float("inf")
        )


def _hosts(cast: _Cast) -> tuple[list[int], list[int]]:
    """Find the parts of bodies by descending area, starting over after each: a distant piece may touch the new one."""
    hosts, others = [0], list(range(1, len(cast.pieces)))
    while new := _next_hosts(cast, hosts, others):
        hosts += new
        others = [piece for piece in others if piece not in new]
    return hosts, others


def _next_hosts(cast: _Cast, hosts: list[int], others: list[int]) -> list[int]:
    """Find the next parts: a piece that touches, or small ones in a row, before a piece that is only near.

    A hand beside a thigh is a part by its arm, if that is in segments, not by the thigh.
    """

    def first(pieces: Iterable[int]) -> list[int]:
        return next(([piece] for piece in pieces if _is_host(cast, piece, hosts)), [])

    touching = [piece for piece in others if cast.gap([piece], hosts) <= _TIGHT]
    return first(touching) or _row(cast, hosts, others) or first(piece for piece in others if piece not in touching)


def _row(cast: _Cast, hosts: list[int], others: list[int]) -> list[int]:
    """Find pieces that touch in a row and reach far together, as the segments of an arm do."""
    free = [piece for piece in others if not _is_covered(cast.distance(piece, hosts))]
    touching = [(i, j) for j in range(len(free)) for i in range(j) if cast.gap([free[i]], [free[j]]) <= _TIGHT]
    for row in _grouped(free, np.array(touching, dtype=np.int64).reshape(-1, 2)):
        area = sum(map(cast.area, row))
        at_hosts = len(row) > 1 and area > _REACHING_AREA and cast.gap(row, hosts) <= _TIGHT
        if at_hosts and _reaches(*_touching(cast, row, hosts), area, _REACH):
            return row
    return []


def _grouped(pieces: Sequence[int], pairs: IntArray) -> list[list[int]]:
    """Group pieces that are connected by pairs (p, 2) of positions in the list."""
    groups: dict[int, list[int]] = {}
    for piece, each in zip(pieces, component_labels(len(pieces), pairs).tolist(), strict=True):
        groups.setdefault(each, []).append(piece)
    return list(groups.values())


def _is_host(cast: _Cast, piece: int, hosts: list[int]) -> bool:
    area, distance = cast.area(piece), cast.distance(piece, hosts)
    gap = float(distance.min())
    if gap > WIDEST_GAP:  # nothing near: a body of its own, unless it is small, or hangs on something that rides
        far = not np.isfinite(gap) and cast.gap([piece], range(piece)) > WIDEST_GAP
        return far or area > _SMALLER * max(cast.area(host) for host in hosts)
    if _is_covered(distance):
        return False
    if area > _REACHING_AREA:
        points, near = cast.samples[piece].points, distance < _nearby(gap)
        if _reaches(points, points[near], area, _REACH) or any(
            _reaches(points, points[each], area, _FROM_JOINT) for each in _joints(cast, piece, hosts, near)
        ):
            return True
    return area > _HELD_AREA and _is_held(cast, piece, hosts)


def _is_covered(distance: FloatArray) -> bool:
    """Check whether most samples of a piece, at these distances from others, touch them."""
    return bool(np.mean(distance < TOUCH) >= _COVERED)


def _reaches(points: FloatArray, touching: FloatArray, area: float, least: float) -> bool:
    """Check whether points of a surface extend far from those that touch others, and are no stick."""
    return _extent(points, touching) > least and not _is_stick(points, touching, area)


def _extent(points: FloatArray, touching: FloatArray) -> float:
    """Measure how far points extend beyond those that touch others."""
    from scipy.spatial import KDTree

    return float(KDTree(touching).query(points)[0].max())


def _nearby(gap: float) -> float:
    """Return the distance up to which samples belong to a contact with this gap."""
    return max(TOUCH, gap + TOUCH / 2)


def _long_axis(points: FloatArray) -> FloatArray:
    """Find the direction along which points are spread most, (3,)."""
    axis: FloatArray = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0]
    return axis


def _joints(cast: _Cast, piece: int, hosts: list[int], near: np.ndarray) -> list[np.ndarray]:
    """List the samples at each joint: an arm whose hand lies on a hip still reaches far from its shoulder."""
    from scipy.spatial import KDTree

    samples, places = cast.samples[piece], np.flatnonzero(near)
    contacts = [(host, cast.contacts[piece, host]) for host in hosts if (piece, host) in cast.contacts]
    closest = np.argmin([contact.distances[places] for _, contact in contacts], axis=0)
    towards = np.empty((len(places), 3))
    for number, (host, contact) in enumerate(contacts):
        own = closest == number
        towards[own] = cast.samples[host].points[contact.nearest[places[own]]] - samples.points[places[own]]
    patch = component_labels(len(places), KDTree(samples.points[places]).query_pairs(TOUCH, output_type="ndarray"))
    patches = [np.flatnonzero(patch == each) for each in range(int(patch.max()) + 1)]
    return [places[own] for own in patches if _is_around(samples.normals[places[own]], towards[own])]


def _is_around(normals: FloatArray, towards: FloatArray) -> bool:
    """Check whether a contact is all around: a thin hand has normals all around, but lies on one side of a hip."""
    towards = towards / np.maximum(np.linalg.norm(towards, axis=1), np.finfo(float).tiny)[:, None]
    return bool(min(1 - np.linalg.norm(side.mean(axis=0)) for side in (normals, towards)) > AROUND)


def _is_stick(points: FloatArray, touching: FloatArray, area: float) -> bool:
    """Check whether a piece is thin and touched in the middle, like a spear in a hand: it does not bend there."""
    along = (points - touching.mean(axis=0)) @ _long_axis(points)
    return bool(min(along.max(), -along.min()) > _REACH and area < _STICK * np.ptp(along) ** 2)


def _held(cast: _Cast, pieces: Sequence[int]) -> IntArray:
    """List the pairs of pieces that hold each other, as positions in the list, (p, 2)."""
    pairs = [(a, b) for b in range(len(pieces)) for a in range(b) if cast.hold(pieces[a], pieces[b])]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _balls(cast: _Cast, hosts: list[int], others: list[int]) -> list[int]:
    """Find the fewest pieces that join hosts which do not hold each other, as the ball of a joint does."""
    apart = component_labels(len(hosts), _held(cast, hosts))
    if not apart.any():
        return []

    def is_free(piece: int) -> bool:
        """Check whether a piece is not covered, or lies between groups of hosts."""
        beside = {group for group, host in zip(apart.tolist(), hosts, strict=True) if cast.gap([piece], [host]) < TOUCH}
        return len(beside) > 1 or not _is_covered(cast.distance(piece, hosts))

    free = [piece for piece in others if is_free(piece)]
    held = _held(cast, hosts + free)

    def groups(kept: BoolArray) -> IntArray:
        """Give each host the number of its group, joined by the pieces that are kept."""
        return component_labels(len(kept), held[kept[held].all(axis=1)])[: len(hosts)]

    kept = np.ones(len(hosts) + len(free), dtype=bool)
    together = groups(kept)
    for one in range(len(kept) - 1, len(hosts) - 1, -1):  # the smallest first
        kept[one] = False
        kept[one] = (groups(kept) != together).any()
    return [piece for piece, needed in zip(free, kept[len(hosts) :], strict=True) if needed]


def _bodies(cast: _Cast, hosts: list[int]) -> tuple[list[list[int]], list[int]]:
    """Group the hosts that hold each other; a small group joins a larger one that it hangs on, or rides."""
    hosts = sorted(hosts)
    ordered = sorted(_grouped(hosts, _held(cast, hosts)), key=lambda group: -sum(map(cast.area, group)))
    bodies: list[list[int]] = []
    touching: list[int] = []
    for group in ordered:
        ways = [(_way(cast, group, body, hosts), body) for body in bodies]
        near = [(way, body) for way, body in ways if way is not None]
        if not near or sum(map(cast.area, group)) >= _SMALLER * max(sum(map(cast.area, body)) for _, body in near):
            bodies.append(group)
            continue
        # the shortest: one by a piece that another body has would be longer than that to this body, so none is in two
        way, body = min(near, key=lambda each: (len(each[0]), cast.gap(group, each[1])))
        if way or _hangs(cast, group, body):
            body += group + way
        else:
            touching += group
    return [sorted(body) for body in bodies], touching


def _hangs(cast: _Cast, group: list[int], body: list[int]) -> bool:
    """Check whether a group hangs on a body by an end, like a leg under a skirt, and does not lie along it."""
    points, near = _touching(cast, group, body)
    return _extent(points, near) > _HANGING * float(np.ptp(points @ _long_axis(points)))


def _touching(cast: _Cast, group: list[int], body: list[int]) -> tuple[FloatArray, FloatArray]:
    """Return the samples of a group of pieces, and those of them that touch a body."""
    points = np.concatenate([cast.samples[piece].points for piece in group])
    distance = np.concatenate([cast.distance(piece, body) for piece in group])
    return points, points[distance < _nearby(float(distance.min()))]


def _way(cast: _Cast, group: list[int], body: list[int], hosts: list[int]) -> list[int] | None:
    """Find the fewest pieces by which a group hangs on a body, none of them a host; None if it does not."""
    before: dict[int, int] = dict.fromkeys(group, -1)
    front = group
    while front:
        for piece in front:
            if cast.gap([piece], body) <= WIDEST_GAP:
                way = []
                while before[piece] >= 0:
                    way.append(piece)
                    piece = before[piece]
                return way
        reached: dict[int, int] = {}
        for piece in front:
            for other in range(len(cast.pieces)):
                if other not in before and other not in hosts and cast.gap([piece], [other]) <= WIDEST_GAP:
                    reached.setdefault(other, piece)
        before |= reached
        front = sorted(reached)
    return None


def _hold(cast: _Cast, i: int, j: int) -> bool:
    """Check whether two pieces form a joint, held all around or in an open end, and do not only touch on one side."""
    gap = cast.gap([i], [j])
    if gap > WIDEST_GAP:
        return False
    limit = _nearby(gap)
    if np.mean(cast.contacts[j, i].distances < limit) < _HOLDING:  # j is the smaller
        return _is_held(cast, i, [j]) or _is_held(cast, j, [i])
    for one, other in ((i, j), (j, i)):
        contact, samples = cast.contacts[one, other], cast.samples[one]
        near = contact.distances < limit
        if _is_around(samples.normals[near], cast.samples[other].points[contact.nearest[near]] - samples.points[near]):
            return True
    return _is_held(cast, i, [j]) or _is_held(cast, j, [i])


def _is_held(cast: _Cast, piece: int, hosts: Iterable[int]) -> bool:
    """Check whether an open end of other pieces lies on a piece."""
    from scipy.spatial import KDTree

    ends = [cast.pieces[host].points[loop] for host in hosts for loop in cast.loops(host)]
    tree = KDTree(cast.samples[piece].points) if ends else None
    return any(np.mean(tree.query(end)[0] < TOUCH) >= _HELD_LOOP for end in ends) if tree else False


def _with_riders(cast: _Cast, bodies: list[list[int]], others: list[int]) -> Roles:
    """Let each of the other pieces ride on what it lies on most or was cut from; a piece on no body becomes a body."""
    hosts = {piece for body in bodies for piece in body}
    hold: dict[int, dict[int, float]] = {piece: {} for piece in others}
    for (i, j), contact in cast.contacts.items():
        if i in hold:
            on_it = float(np.mean(np.exp(-((contact.distances / TOUCH) ** 2))))
            hold[i][j] = on_it + float(_is_cut_from(cast, i, j)) + 1e-9 / (contact.gap + 1e-3)
    carrier = carriers(hold, hosts)
    riders: list[tuple[int, int]] = []
    placed = set(hosts)
    while ready := [(i, j) for i, j in carrier.items() if i not in placed and j in placed]:
        riders += sorted(ready, key=lambda rider: (-hold[rider[0]][rider[1]], rider))
        placed |= {i for i, _ in ready}
    return Roles(bodies + [[piece] for piece in others if piece not in placed], riders)


def _is_cut_from(cast: _Cast, piece: int, other: int) -> bool:
    """Check whether the whole border of a piece lies along the border of a larger one."""
    from scipy.spatial import KDTree

    reach = _SEAM * np.sqrt(cast.area(piece))
    if other > piece or cast.contacts[piece, other].gap > TOUCH or not (cast.loops(piece) and cast.loops(other)):
        return False
    own, ends = (cast.pieces[each].points[np.concatenate(cast.loops(each))] for each in (piece, other))
    return bool(np.isfinite(KDTree(ends).query(own, distance_upper_bound=reach)[0]).all())


def _border_loops(faces: IntArray) -> list[IntArray]:
    """List the vertices along each border that is long enough."""
    label = border_labels(faces, edge_table(faces))
    loops = [np.flatnonzero(label == index) for index in range(int(label.max()) + 1)]
    return [loop for loop in loops if len(loop) >= _LOOP]
