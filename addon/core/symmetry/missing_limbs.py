"""What seems to be missing among the limbs of a body, or to be none."""

from __future__ import annotations

import numpy as np

from ..run.monitor import Monitor
from .limbs import Limbs

_LIMBLESS = 2  # ends of a tube or a snake
_PAIRS, _MIDDLE = 2, 2  # arms and legs; head and tail


def warn_of_missing_limbs(limbs: Limbs, monitor: Monitor, *, joined: bool) -> None:
    """Warn if limbs seem to be missing, or to be none.

    A body has two pairs of limbs or more, a head, and perhaps a tail. What has fewer or more lacks a limb, or has
    something among them that is none; nearly all forms that are wrong do.

    `limbs`: head, tail and sides; `joined`: whether the surface is made of several pieces, so that it is no tube.

    Examples
    --------
    >>> from scipy.spatial.distance import cdist
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> ends = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0]]) / 3
    >>> limbs = limbs_of(cdist(ends, ends), np.zeros((4, 4, 4)), np.full(4, 2.0), lambda: np.arange(4.0))
    >>> monitor = Monitor()
    >>> warn_of_missing_limbs(limbs, monitor, joined=False)
    >>> [told.kind for told in monitor.warnings]
    ['no_head']
    """
    count = len(limbs.partner)
    middle = int(np.count_nonzero(limbs.partner == np.arange(count)))
    pairs = (count - middle) // 2
    if count == _LIMBLESS and not joined:
        return
    if pairs == 0:
        monitor.warn("no_pairs", count=count)
    elif pairs < _PAIRS:
        monitor.warn("one_pair")
    elif middle == 0:
        monitor.warn("no_head")
    elif middle > _MIDDLE:
        monitor.warn("unpaired_ends", count=middle - _MIDDLE)
