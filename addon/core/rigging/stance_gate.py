"""Whether a body may be put into a stance by a fitted skeleton: what is doubtful is told, what is wrong not written."""

from __future__ import annotations

from collections.abc import Sequence

from .candidates import Candidate

_EXPLAINED = 0.045  # residual above which the skin is not that of the skeleton
_UNLIKELY = 5.0  # cost above which something is wrong, if not the side then a limb
_STRAINED = 0.035  # median change of edge lengths above which the skin does not follow the skeleton
_CLOSE = 0.5  # of cost: another way to face is about as likely


def refusal(chosen: Candidate, distortion: float) -> str:
    """Return the kind of message that says why a stance cannot be right; empty if nothing speaks against it.

    `distortion`: median change of the lengths of edges in it.

    Made on 42 poses of 14 characters, proved on 87 of 29 others: docs/results.md.
    """
    if chosen.residual > _EXPLAINED:
        return "stance_unlike"
    if distortion > _STRAINED:
        return "stance_strained"
    return "stance_unlikely" if chosen.cost > _UNLIKELY else ""


def is_doubtful(found: Sequence[Candidate]) -> bool:
    """Return whether another way to face is about as likely as the first."""
    return len(found) > 1 and found[1].cost - found[0].cost < _CLOSE
