"""The way from a body to a reference over the mannequin, which explains human bodies that no match brings together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np

from ..matching.unfolded import Unfolded
from ..mesh.closest_points import closest_points
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .candidates import Candidate, Points, candidate_by, candidates
from .reference_rig import ReferenceRig
from .references import Reference
from .stance_gate import refusal
from .standing import strained

_APART = 0.06  # of the mannequin's size: points of two bodies that lie that far apart on it are hardly the same
_TRUST = 0.35  # mean trust in the skin, of bodies that are no human ones, below which they are not alike


class Alike(Enum):
    """Whether two bodies are of one kind."""

    YES = 1
    PERHAPS = 2
    NO = 3


class Bridge(NamedTuple):
    """What the mannequin knows of two bodies.

    Attributes
    ----------
    candidates : list of Candidate
        The skeleton of the reference in every way in which the mannequin says that the body may face, the likeliest
        first; empty unless both are human.
    humans : int
        How many of both are human.
    """

    candidates: list[Candidate]
    humans: int

    def alike(self, best: Candidate) -> Alike:
        """Return whether both are of one kind, where a match fits badly. `best`: the skeleton that fits best."""
        if self.humans == 1 or (self.humans == 0 and best.trust < _TRUST):
            return Alike.NO
        return Alike.YES if self.humans else Alike.PERHAPS


def over_mannequin(
    one: Unfolded,
    reference: Reference,
    adult: Reference,
    builds: Callable[[], Sequence[Reference]],
    monitors: tuple[Monitor, Monitor],
) -> Bridge:
    """Fit the skeleton of a reference to a body by the points of the mannequin that both of them are.

    So what the mannequin knows of joints, toes and proportions decides, whatever the bones of the reference are called.

    `one`: the body; `adult`, `builds`: the mannequin, and gives it in other proportions; `monitors`: of the work on
    the body and on the reference.
    """
    fits, humans = [], 0
    for body, monitor in zip((one, reference.body), monitors, strict=True):
        with monitor.stage("Ways to face"):
            fits.append(candidates(body, adult, builds, monitor))
        humans += _is_human(body, fits[-1][0], monitor)
    if humans < len(fits):
        return Bridge([], humans)
    here, there = fits
    faces, size = reference.rig.faces, float(np.ptp(adult.rig.vertices, axis=0).max())
    others, known = _on_mannequin(there[0], adult.rig), there[0].fit.closeness()[:, None]
    found = []
    for way in here:
        near = closest_points(others, faces, _on_mannequin(way, adult.rig), monitors[1])
        sure = way.fit.closeness() * near.on(known, faces)[:, 0] * np.exp(-((near.distances / size / _APART) ** 2))
        own = candidate_by(one, reference, Points(near, sure), monitors[1])
        found.append(own._replace(cost=own.cost + way.cost - here[0].cost))  # of the ways to face, it knows more
    return Bridge(found, humans)


def _is_human(body: Unfolded, best: Candidate, monitor: Monitor) -> bool:
    """Return whether a body could be put into a T-pose by the mannequin's skeleton that explains it best."""
    if refusal(best, 1.0) is not None:
        return False
    return refusal(best, 1.0, *strained(body, best.reference.rig, best.fit, monitor)) is None


def _on_mannequin(found: Candidate, adult: ReferenceRig) -> FloatArray:
    """Find the points of the adult mannequin that the vertices of a body are, (n, 3), in whatever build explains it."""
    build = found.reference.rig
    return closest_points(build.vertices, build.faces, found.fit.at).on(adult.vertices, adult.faces)
