"""Which piece carries which."""

from itertools import product

import numpy as np
import pytest

from addon.core.assembly.carriers import carriers


def best_of_all(hold, hosts):
    """Try every choice of carriers that leads to the hosts."""
    pieces, found = sorted(hold), []
    for choice in product(*(hold[piece] for piece in pieces)):
        carrier = dict(zip(pieces, choice, strict=True))
        ends = list(pieces)
        for _ in pieces:
            ends = [carrier.get(end, end) for end in ends]
        if hosts.issuperset(ends):
            found.append(sum(hold[piece][on] for piece, on in carrier.items()))
    return max(found)


@pytest.mark.parametrize("seed", range(60))
def test_they_are_the_best_of_all_that_lead_to_a_host(seed):
    chance = np.random.default_rng(seed)
    pieces, hosts = range(2, 7), {0, 1}
    hold = {
        i: {j: float(chance.random()) for j in range(7) if j != i and (j < 2 or chance.random() < 0.6)} for i in pieces
    }
    for i in pieces:
        hold[i] = {
            j: how * (0.2 if j < 2 else 1.0) for j, how in hold[i].items() if j > 1 or chance.random() < 0.5 or i == 2
        }
    reached = set(hosts)
    for _ in pieces:
        reached |= {i for i in pieces if reached & hold[i].keys()}
    found = carriers(hold, hosts)
    assert found.keys() == reached - hosts
    possible = {i: {j: how for j, how in hold[i].items() if j in reached} for i in found}
    assert sum(hold[i][j] for i, j in found.items()) == pytest.approx(best_of_all(possible, hosts))
    for piece in found:
        way = [piece]
        while way[-1] not in hosts:
            way.append(found[way[-1]])
            assert len(way) < 9


def test_rings_within_rings():
    hold = {1: {2: 0.9}, 2: {1: 0.9, 3: 0.5}, 3: {1: 0.8, 4: 0.4}, 4: {3: 0.9, 0: 0.1}}
    assert carriers(hold, {0}) == {1: 2, 2: 3, 3: 4, 4: 0}


def test_ties_go_to_the_first():
    assert carriers({2: {0: 0.5, 1: 0.5}, 3: {2: 0.5, 1: 0.5}}, {0, 1}) == {2: 0, 3: 1}


def test_what_leads_to_no_host_has_no_carrier():
    assert carriers({1: {2: 1.0}, 2: {1: 1.0}, 3: {1: 1.0}, 4: {}}, {0}) == {}
