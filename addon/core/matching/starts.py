"""Starts of a match: alignments of one form to another, with the corresponding feature points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..measures.alignment import closest_points_from, half_turns, rigid_fit
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..symmetry.limb_names import named_images
from .assignments import feature_assignments
from .laying import completed
from .unfolded import Unfolded

_ASSIGNMENTS = 6  # best ones that are tried
_ITERATIONS = 25  # of closest points
_FEWEST = 3  # pairs of feature points that tell a motion
_SAME = np.cos(np.radians(25))  # cosine of the angle below which two motions count as one


class Start(NamedTuple):
    """An alignment of one form to another.

    Attributes
    ----------
    image : (k,) ndarray of int
        For each feature point the corresponding one of the other surface; -1 for none.
    rotation : (3, 3) ndarray of float
        R, proper.
    shift : (3,) ndarray of float
        t; the motion is ``x ↦ x R + t``.
    """

    image: IntArray
    rotation: FloatArray
    shift: FloatArray


def starts(one: Unfolded, other: Unfolded, rows: IntArray, monitor: Monitor) -> list[Start]:
    """Find the possible starts of a match.

    From the names of feature points if three were given by hand; else from their likeliest assignments and the mirror
    images of these, from their numbers if both surfaces have equally many, and from the principal axes of the forms.
    Each is refined by iterative closest points. Of those from the axes, only motions that no assignment leads to are
    kept.

    `one, other`: the surfaces; `rows` (r,).

    Examples
    --------
    >>> from addon.core.matching.unfolded import unfolded
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> way = starts(body, body, np.arange(4), Monitor())[0]
    >>> np.allclose(way.rotation, np.eye(3)), np.allclose(way.shift, 0)
    (True, True)

    References
    ----------
    Besl and McKay, "A Method for Registration of 3-D Shapes", 1992.
    """
    told = named_images(one.limbs, other.limbs)
    named = [image for image in told if np.count_nonzero(image >= 0) >= _FEWEST]
    images = named or _agreeing(_likeliest(one, other), told, lambda image: image)
    found: list[Start] = []
    for image in images:
        known = np.flatnonzero(image >= 0)
        if len(known) < _FEWEST or any((image == each.image).all() for each in found):
            continue
        monitor.check()
        begin = rigid_fit(one.form[one.features[known]], other.form[other.features[image[known]]])
        found.append(
            Start(image, *closest_points_from(one.form[rows], other.form, *begin, max_iterations=_ITERATIONS)[:2])
        )
    for rotation, shift in [] if named else _by_axes(one, other):
        monitor.check()
        rotation, shift, _ = closest_points_from(
            one.form[rows], other.form, rotation, shift, max_iterations=_ITERATIONS
        )
        if any((np.trace(each.rotation.T @ rotation) - 1) / 2 > _SAME for each in found):
            continue
        tips = one.form[one.features] @ rotation + shift
        image = completed(np.full(len(tips), -1), tips, other.form[other.features])
        found.append(Start(image, rotation, shift))
    return _agreeing(found, told, lambda start: start.image)


def _likeliest(one: Unfolded, other: Unfolded) -> list[IntArray]:
    """List the likeliest assignments of feature points, and those by number if both surfaces have equally many.

    The likeliest alone could be all of one side, or of arms and legs that disagree.
    """
    images = [image for image, _ in feature_assignments(one.limbs, other.limbs, _ASSIGNMENTS)]
    images += [np.where(image >= 0, other.limbs.partner[image], -1) for image in images]
    return images + _by_number(one) if len(one.features) == len(other.features) else images


def _agreeing(found: list[Any], told: list[IntArray], image_of: Callable[[Any], IntArray]) -> list[Any]:
    """Keep what maps feature points as their names say, in one of the images `told`, (k,) each; all if nothing does."""

    def agrees(image: IntArray) -> bool:
        return any(((image == each) | (image < 0))[each >= 0].all() for each in told)

    return [each for each in found if agrees(image_of(each))] or found


def _by_number(one: Unfolded) -> list[IntArray]:
    """Assign feature points by their lasting numbers, as they are and with left and right swapped."""
    as_numbered = np.arange(len(one.features))
    return [as_numbered, one.limbs.partner]


def _by_axes(one: Unfolded, other: Unfolded) -> list[tuple[FloatArray, FloatArray]]:
    """Align the principal axes, by the four proper rotations."""
    return half_turns(one.form, one.areas, other.form, other.areas)
