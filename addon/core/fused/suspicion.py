"""Whether a body looks as if its skin had grown together: by the lowest eigenvalues of its surface."""

from __future__ import annotations

from ..numerics.arrays import FloatArray

_LIMBS = 5  # of a human body, with the head: as many ends make one fewer low eigenvalues, with a gap above them
_GAP = 1.5  # of the next eigenvalue over the last low one: whole bodies have 1.6 to 2.2
_HIGHEST = 4.3  # of the last low eigenvalue over the first: whole bodies have 2.3 to 4.2
_TALL = 10.5  # first eigenvalue of unit area: human bodies have 4 to 10, animals on four legs 11 to 22


def may_have_grown_together(eigenvalues: FloatArray) -> bool:
    """Tell whether a body that may be a human one has not as many free limbs as that.

    Each end of a body that is free has low frequencies of its own; an arm that has grown together with the trunk has
    none. The eigenvalues tell it of webs, too, which are no handles, and do not depend on the pose.

    `eigenvalues` (k,): ascending from 0, of the surface scaled to unit area.

    Examples
    --------
    >>> import numpy as np
    >>> may_have_grown_together(np.array([0, 5.6, 9.2, 13.3, 18.0, 34.1]))  # a man
    False
    >>> may_have_grown_together(np.array([0, 5.7, 18.7, 31.2, 31.6, 35.3]))  # with his hands on his belly
    True

    References
    ----------
    Reuter, Wolter and Peinecke, "Laplace-Beltrami spectra as 'Shape-DNA' of surfaces and solids", 2006,
    doi:10.1016/j.cad.2005.10.011.
    """
    if len(eigenvalues) <= _LIMBS or not 0 < eigenvalues[1] < _TALL:
        return False
    lowest, last, above = (float(eigenvalues[at]) for at in (1, _LIMBS - 1, _LIMBS))
    return above < _GAP * last or last > _HIGHEST * lowest
