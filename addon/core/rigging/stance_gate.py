"""Whether a body may be put into a stance by a fitted skeleton: what is doubtful is told, what is wrong not written."""

from __future__ import annotations

from collections.abc import Sequence

from ..run.errors import InvalidMeshError
from ..run.monitor import Monitor
from .candidates import Candidate

_EXPLAINED = 0.045  # residual above which the skin is not that of the skeleton
_SURE = 0.1  # mean confidence of the match below which it is none
_WHOLE = 0.6  # share of the mesh's area below which a body is but a part of what should stand
_LOST, _OFF = 0.15, 20.0  # skin of a bone, over that of its partner, and degrees off a limb's way: a limb is not found
_STRAINED = 0.06  # median change of edge lengths above which the skin does not follow the skeleton
_DOUBTS = 3  # of what follows, that together are too much
_UNUSUAL = {  # what only one right stance in twenty exceeds
    "residual": 0.026,
    "degrees": 100.0,
    "unlike": 0.127,
    "skin": 0.66,  # or is below
    "confidence": 0.44,  # the same
    "distortion": 0.014,
    "off": 11.3,
}
_CLOSE = 2.5  # of cost: the other way to face is usually 3 to 5 worse, and may be the right one if it is not
_CLOSE_BY_SKIN = 0.2, 0.1  # the same, where the skin alone tells: share of the cost, and least


def refusal(chosen: Candidate, share: float, distortion: float = 0.0, off: float = 0.0) -> InvalidMeshError | None:
    """Return the error that says why a stance cannot be right; None if nothing speaks against it.

    One measure far out is enough, or three that are unusual.

    `share`: of the mesh's area, that of the body; `distortion`: median change of the lengths of edges in the stance;
    `off`: degrees by which a limb lies off its way in it; both 0 where there is no stance.

    Made on 42 poses of 14 characters, proved on others: docs/appendix.md.
    """
    if share < _WHOLE:
        return InvalidMeshError("stance_parts", share=share)
    if chosen.residual > _EXPLAINED or chosen.confidence < _SURE:
        return InvalidMeshError("stance_unlike")
    if chosen.skin < _LOST or off > _OFF:
        return InvalidMeshError("stance_limb")
    if distortion > _STRAINED:
        return InvalidMeshError("stance_strained")
    degrees = sum(chosen.degrees.values())
    doubts = [
        chosen.residual > _UNUSUAL["residual"],
        degrees > _UNUSUAL["degrees"],
        chosen.unlike > _UNUSUAL["unlike"],
        chosen.skin < _UNUSUAL["skin"],
        chosen.confidence < _UNUSUAL["confidence"],
        distortion > _UNUSUAL["distortion"],
        off > _UNUSUAL["off"],
    ]
    if sum(doubts) >= _DOUBTS:
        return InvalidMeshError("stance_unlikely")
    return None


def is_doubtful(found: Sequence[Candidate]) -> bool:
    """Return whether another way to face may be the right one."""
    if len(found) < 2:
        return False
    best, other = (each.cost for each in found[:2])
    share, least = _CLOSE_BY_SKIN
    margin = _CLOSE if found[0].reference.rig.is_human else max(share * best, least)
    return other - best < margin


def pass_gate(
    error: InvalidMeshError | None, found: Sequence[Candidate], side: str | int, anyway: bool, monitor: Monitor
) -> None:
    """Refuse what cannot be right, unless it is wanted anyway; tell what is doubtful.

    `error`: what `refusal` returned; `found`: all ways to face; `side`: the one that was asked for.
    """
    if error is not None:
        if not anyway:
            raise error
        monitor.warn("stance_doubtful")
    elif side == "auto" and is_doubtful(found):
        monitor.warn("match_sides")
