"""The proportions of the mannequin: an adult 1.75 m tall, arms held out sideways, in metres.

X points to its left, Y backwards, Z up. Lengths and girths are those of an average adult, between man and woman.
"""

from __future__ import annotations

from itertools import pairwise

from .solids import Ellipsoid, Point, RoundCone

SHOULDER = (0.165, 0.02, 1.425)  # the left one

_HEAD = (
    Ellipsoid((0, 0, 1.655), (0.074, 0.096, 0.092)),
    Ellipsoid((0, 0.035, 1.645), (0.068, 0.075, 0.08)),
    Ellipsoid((0, -0.045, 1.6), (0.056, 0.06, 0.07)),  # the face
    RoundCone((0, -0.065, 1.545), (0, -0.088, 1.54), 0.026, 0.018),  # the chin
    RoundCone((0, -0.095, 1.645), (0, -0.118, 1.61), 0.008, 0.014),  # the nose
)
_TRUNK = (
    RoundCone((0, 0.03, 1.43), (0, 0.012, 1.58), 0.06, 0.053),  # the neck
    Ellipsoid((0, 0.01, 1.29), (0.155, 0.1, 0.19)),
    Ellipsoid((0, 0, 1.08), (0.135, 0.095, 0.16)),
    Ellipsoid((0, 0.01, 0.96), (0.16, 0.105, 0.11)),
)
_LEFT = (
    RoundCone((0.072, 0, 1.64), (0.082, 0.012, 1.625), 0.01, 0.018),  # the ear
    RoundCone((0, 0.025, 1.435), (0.15, 0.02, 1.42), 0.055, 0.058),  # the shoulder
    Ellipsoid((0.075, -0.06, 1.3), (0.072, 0.05, 0.06)),  # the chest
    Ellipsoid((0.07, 0.08, 1.36), (0.07, 0.035, 0.09)),  # the shoulder blade
    Ellipsoid((0.075, 0.075, 0.91), (0.08, 0.075, 0.085)),  # the buttock
    RoundCone((0.09, 0.005, 0.9), (0.095, 0, 0.5), 0.086, 0.052),  # the thigh
    Ellipsoid((0.095, -0.03, 0.7), (0.06, 0.055, 0.18)),
    RoundCone((0.095, -0.005, 0.5), (0.1, 0.025, 0.09), 0.05, 0.037),  # the shin
    Ellipsoid((0.098, 0.04, 0.37), (0.046, 0.05, 0.12)),  # the calf
    RoundCone((0.1, 0.055, 0.04), (0.1, 0.06, 0.04), 0.034, 0.034),  # the heel
    RoundCone((0.1, 0.02, 0.065), (0.112, -0.09, 0.03), 0.038, 0.034),  # the foot
    RoundCone((0.1, -0.09, 0.025), (0.1, -0.175, 0.02), 0.026, 0.02),  # the toes
    RoundCone((0.125, -0.085, 0.025), (0.13, -0.15, 0.018), 0.026, 0.018),
)
_ELBOW, _WRIST, _KNUCKLES = 0.28, 0.53, 0.615  # from the shoulder
_FINGERS = (  # offset of each from the hand's middle at the knuckles and at its tip, and its length
    (-0.032, -0.045, 0.075),
    (-0.011, -0.016, 0.085),
    (0.01, 0.014, 0.078),
    (0.03, 0.042, 0.06),
)
_THUMB = ((0.55, -0.02, -0.004), (0.59, -0.055, -0.01), (0.64, -0.085, -0.016))


def human() -> list[RoundCone | Ellipsoid]:
    """List the solids of the mannequin.

    Examples
    --------
    >>> solids = human()
    >>> float(max(solid.bounds()[1][2] for solid in solids))
    1.747
    """
    left = [*_LEFT, *_arm()]
    return [*_HEAD, *_TRUNK, *left, *map(_mirrored, left)]


def _arm() -> list[RoundCone | Ellipsoid]:
    """List the solids of the left arm."""
    arm: list[RoundCone | Ellipsoid] = [
        RoundCone(_along(0), _along(_ELBOW, 0.012), 0.054, 0.041),
        RoundCone(_along(_ELBOW, 0.012), _along(_WRIST), 0.041, 0.028),
        Ellipsoid(_along(0.35, 0.01), (0.06, 0.04, 0.04)),
    ]
    for knuckle, tip, length in _FINGERS:
        arm.append(RoundCone(_along(0.54, 0.6 * knuckle), _along(_KNUCKLES, knuckle), 0.019, 0.015))
        arm.append(RoundCone(_along(_KNUCKLES, knuckle), _along(_KNUCKLES + length, tip, -0.008), 0.0115, 0.009))
    joints = [_along(*joint) for joint in _THUMB]
    radii = (0.018, 0.0135, 0.01)
    arm += [RoundCone(*ends, *wide) for ends, wide in zip(pairwise(joints), pairwise(radii), strict=True)]
    return arm


def _along(out: float, back: float = 0.0, up: float = 0.0) -> Point:
    """Return a point of the left arm."""
    return SHOULDER[0] + out, SHOULDER[1] + back, SHOULDER[2] + up


def _mirrored(solid: RoundCone | Ellipsoid) -> RoundCone | Ellipsoid:
    """Mirror a solid of the left side to the right one."""
    if isinstance(solid, Ellipsoid):
        return solid._replace(centre=_across(solid.centre))
    return solid._replace(start=_across(solid.start), end=_across(solid.end))


def _across(point: Point) -> Point:
    """Mirror a point."""
    return -point[0], point[1], point[2]
