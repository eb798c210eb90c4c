"""The choice of a carrier for each piece that lies on several others."""

from __future__ import annotations

from collections.abc import Mapping, Set


def carriers(hold: Mapping[int, Mapping[int, float]], hosts: Set[int]) -> dict[int, int]:
    """Choose the carrier of every piece so that the total contact with the carriers is largest.

    Each rides on what it lies on most, unless pieces would carry each other in a cycle: of these, the one that loses
    least rides on something else. The result is the maximum branching that leads to the hosts.

    `hold`: for each piece that rides, how much it lies on others; `hosts`: the pieces that need no carrier.

    Examples
    --------
    >>> carriers({1: {0: 0.2, 2: 0.9}, 2: {0: 0.3, 1: 0.8}, 3: {2: 0.5}, 4: {5: 0.5}}, {0})
    {1: 2, 2: 0, 3: 2}

    References
    ----------
    Edmonds, "Optimum Branchings", 1967, doi:10.6028/jres.071B.032.
    """
    return _branching(_leading_to(hold, hosts))


def _branching(hold: Mapping[int, Mapping[int, float]]) -> dict[int, int]:
    """Find the best carriers; a cycle is contracted to one piece, and later broken where that costs least."""
    best = {i: max(on, key=lambda j: (on[j], -j)) for i, on in hold.items()}
    ring = _ring(best)
    if not ring:
        return best
    whole = max(hold.keys() | {j for on in hold.values() for j in on}) + 1
    ways: dict[int, dict[int, float]] = {whole: {}}
    enters: dict[int, int] = {}  # the piece of the cycle on which others would ride
    leaves: dict[int, int] = {}  # the piece of the cycle that would ride on others
    for i, on in hold.items():
        for j, how in on.items():
            if i in ring and j not in ring:
                gain = how - on[best[i]]
                if gain > ways[whole].get(j, -float("inf")):
                    ways[whole][j], leaves[j] = gain, i
            elif i not in ring:
                own, to = ways.setdefault(i, {}), whole if j in ring else j
                if how > own.get(to, -float("inf")):
                    own[to] = how
                    if j in ring:
                        enters[i] = j
    found = _branching(ways)
    onto = found.pop(whole)
    carrier = {i: enters[i] if j == whole else j for i, j in found.items()}
    return {**{i: best[i] for i in ring}, **carrier, leaves[onto]: onto}


def _leading_to(hold: Mapping[int, Mapping[int, float]], hosts: Set[int]) -> dict[int, Mapping[int, float]]:
    """Remove pieces from which no path leads to a host, and the paths to them."""
    reached = set(hosts)
    while more := {i for i, on in hold.items() if i not in reached and not reached.isdisjoint(on)}:
        reached |= more
    return {i: {j: how for j, how in on.items() if j in reached} for i, on in hold.items() if i in reached}


def _ring(carrier: Mapping[int, int]) -> set[int]:
    """Find pieces that carry each other in a cycle, if there are any."""
    done: set[int] = set()
    for piece in carrier:
        way: list[int] = []
        while piece in carrier and piece not in done:
            done.add(piece)
            way.append(piece)
            piece = carrier[piece]
        if piece in way:
            return set(way[way.index(piece) :])
    return set()
