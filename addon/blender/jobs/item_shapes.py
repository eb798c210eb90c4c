"""Shapes of a body besides its form: those between pose and form, and the form of some limbs only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..objects.combining import Combined
from ..results.in_betweens import fractions_between
from ..results.limb_states import limbs_by_point
from ..words.limb_words import PARTS
from ..words.wording import told
from .request import Request

if TYPE_CHECKING:
    from ...core import KeptStages
    from ...core.numerics.arrays import FloatArray
    from ...core.results import AnyResult
    from ...core.run.monitor import Cancelled


def chosen_limbs(obj: bpy.types.Object, request: Request) -> dict[int | str, bool]:
    """Return which limbs a run is to straighten: the one that was asked for, or those that an update finds.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    request : Request
        What was asked for.

    Returns
    -------
    dict of int or str to bool
        As from `limbs_by_point`; empty for all limbs.
    """
    if request.limb:
        return {name: name == request.limb for name in (*PARTS, "")}
    return limbs_by_point(obj.data) if request.live else {}


def kept_limbs(
    limbs: Sequence[Mapping[int | str, bool]], whole: Combined, found: AnyResult, wanted: str = ""
) -> list[bool]:
    """Find the limbs that were chosen on a new form.

    Parameters
    ----------
    limbs : sequence of mapping
        Of each object, as from `chosen_limbs`.
    whole : Combined
        The objects as one mesh.
    found : CanonicalForm
        Their new form.
    wanted : str
        The only limb that was asked for, if one was.

    Returns
    -------
    list of bool
        For each patch, whether its pose is removed; empty if that of all is. A limb that ends elsewhere now is known by
        its name, and one that was not there before is straightened.

    Raises
    ------
    CanonicalFormError
        If the limb that was asked for was not found.
    """
    if not any(limbs):
        return []
    owned = whole.owned(found.feature_points)
    flags = []
    for number, name in enumerate(found.feature_names):
        points = [(each, int(own[number])) for each, own in zip(limbs, owned, strict=True)]
        by_point = [each[point] for each, point in points if point in each]
        by_name = [each[name] for each in limbs if name in each]
        flags.append(next(iter([*by_point, *by_name]), True))
    if wanted and not any(flags):
        raise CanonicalFormError(
            told(
                "This limb was not found: {limb}. Under Body, click on its end, then on the mesh, and try again.",
                limb=told(PARTS[wanted]),
            )
        )
    return [] if all(flags) else flags


def shapes_of(
    whole: Combined,
    found: AnyResult,
    count: int,
    limbs: Sequence[bool] = (),
    *,
    together: bool,
    keep: KeptStages | None = None,
    cancelled: Cancelled | None = None,
) -> list[FloatArray]:
    """Compute the shapes between pose and form; their warnings are added to those of the form.

    Parameters
    ----------
    whole : Combined
        The objects as one mesh.
    found : CanonicalForm or PosedLike
        Their form.
    count : int
        Number of shapes between.
    limbs : sequence of bool
        For each patch, whether its pose is removed; empty if that of all is.
    together : bool
        As in the settings.
    keep : KeptStages, optional
        Stages kept from earlier runs.
    cancelled : callable, optional
        As in `canonical_form`.

    Returns
    -------
    list of (n, 3) ndarray of float
        Those between, then the form of the limbs if it is not the whole one.
    """
    if not count and not limbs:
        return []
    from ...core.limbs import limb_shapes
    from ...core.run.monitor import Monitor

    monitor = Monitor(None, cancelled, keep=keep)
    chosen = np.ones(len(whole.vertices), dtype=bool)
    if limbs:
        chosen = np.array([*limbs, False])[found.patches]  # index -1, no patch, is the last element
    shapes = limb_shapes(
        whole.vertices,
        whole.faces,
        found.vertices,  # type: ignore[union-attr]
        chosen,
        ways=[*fractions_between(count), *([1.0] if limbs else [])],
        together=together,
        rest=whole.rest,
        monitor=monitor,
    )
    found.warnings.extend(monitor.warnings)
    return shapes
