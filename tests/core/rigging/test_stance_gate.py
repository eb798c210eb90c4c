"""The gate of stances and rigs: what is refused, what is told, and what passes without a word."""

from types import SimpleNamespace
from typing import Any

import pytest

from addon.core import InvalidMeshError
from addon.core.rigging.candidates import Candidate
from addon.core.rigging.stance_gate import is_doubtful, pass_gate, refusal
from addon.core.run.monitor import Monitor

GOOD: dict[str, Any] = {"residual": 0.01, "degrees": {"hand.L": 20.0}, "unlike": 0.03, "skin": 0.9, "confidence": 0.7}
HUMAN: Any = SimpleNamespace(rig=SimpleNamespace(is_human=True))
ANIMAL: Any = SimpleNamespace(rig=SimpleNamespace(is_human=False))
UNUSUAL: dict[str, Any] = {
    "residual": 0.03,
    "degrees": {"hand.L": 150.0},
    "unlike": 0.2,
    "skin": 0.5,
    "confidence": 0.3,
}


def fitted(cost: float = 0.0, **measures: Any) -> Candidate:
    """A candidate of which only what the gate reads is known."""
    found: dict[str, Any] = {**dict.fromkeys(Candidate._fields), **GOOD, **measures, "cost": cost, "reference": HUMAN}
    return Candidate(**found)


def kind_of(error: InvalidMeshError | None) -> str:
    return "" if error is None else error.kind


def test_a_good_stance_passes():
    assert refusal(fitted(), 1.0, 0.003, 4.0) is None


@pytest.mark.parametrize(
    ("measures", "others", "kind"),
    [
        ({}, (0.5, 0.0, 0.0), "stance_parts"),
        ({"residual": 0.06}, (1.0, 0.0, 0.0), "stance_unlike"),
        ({"confidence": 0.05}, (1.0, 0.0, 0.0), "stance_unlike"),
        ({"skin": 0.02}, (1.0, 0.0, 0.0), "stance_limb"),
        ({}, (1.0, 0.0, 40.0), "stance_limb"),
        ({}, (1.0, 0.1, 0.0), "stance_strained"),
    ],
)
def test_one_measure_far_out_is_enough(measures, others, kind):
    assert kind_of(refusal(fitted(**measures), *others)) == kind


@pytest.mark.parametrize("names", [("residual", "degrees"), ("unlike", "skin"), ("confidence", "unlike")])
def test_three_unusual_measures_refuse_and_two_do_not(names):
    two = {name: UNUSUAL[name] for name in names}
    assert refusal(fitted(**two), 1.0) is None
    assert kind_of(refusal(fitted(**two), 1.0, 0.02)) == "stance_unlikely"


@pytest.mark.parametrize(("costs", "doubt"), [((0.5,), False), ((0.5, 4.5), False), ((0.5, 2.0), True)])
def test_a_second_way_that_is_nearly_as_likely_is_told(costs, doubt):
    found = [fitted(cost) for cost in costs]
    assert is_doubtful(found) is doubt
    for side in ("auto", 1):
        monitor = Monitor()
        pass_gate(None, found, side, False, monitor)
        assert [each.kind for each in monitor.warnings] == (["match_sides"] if doubt and side == "auto" else [])


@pytest.mark.parametrize(("costs", "doubt"), [((0.0, 0.05), True), ((1.0, 1.15), True), ((1.0, 1.3), False)])
def test_where_only_the_skin_tells_a_smaller_margin_is_enough(costs, doubt):
    assert is_doubtful([fitted(cost)._replace(reference=ANIMAL) for cost in costs]) is doubt


def test_what_is_refused_is_kept_only_if_wanted():
    error, monitor = InvalidMeshError("stance_limb"), Monitor()
    with pytest.raises(InvalidMeshError):
        pass_gate(error, [fitted()], "auto", False, monitor)
    pass_gate(error, [fitted()], "auto", True, monitor)
    assert [each.kind for each in monitor.warnings] == ["stance_doubtful"]
