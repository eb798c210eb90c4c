"""Whether a body looks as if its skin had grown together: by the lowest eigenvalues of its surface."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray

# Means over 190 whole bodies of unit area (MakeHuman builds, FAUST, TOSCA): five ends make four low ones.
_WHOLE = np.array([6.1, 10.2, 14.2, 18.9, 36.2, 39.8])
_TALL = (3.5, 10.5)  # the first, of bodies as tall for their skin as humans: on four legs it is 11 to 22
SUSPECT = 0.112  # unlikeness above which skin may have grown together: those have at most .108


def unlike_whole_human(eigenvalues: FloatArray) -> float:
    """Measure how unlike the lowest eigenvalues of a body are those of a human one that is whole, whatever its size.

    Each end of a body that is free has low frequencies of its own; an arm that has grown together with the trunk has
    none. So they tell of webs, too, which are no handles, and do not depend on the pose.

    `eigenvalues` (k,): ascending from 0, of the surface scaled to unit area; gives the mean deviation of their
    logarithms, 0 for a body that is not as tall as a human one.

    Examples
    --------
    >>> unlike_whole_human(np.array([0, 5.6, 9.2, 13.3, 18.0, 34.1, 37.1])) < SUSPECT  # a man
    True
    >>> unlike_whole_human(np.array([0, 5.7, 18.7, 31.2, 31.6, 35.3, 56.8])) > SUSPECT  # with his hands on his belly
    True

    References
    ----------
    Reuter, Wolter and Peinecke, "Laplace-Beltrami spectra as 'Shape-DNA' of surfaces and solids", 2006,
    doi:10.1016/j.cad.2005.10.011.
    """
    own = eigenvalues[1 : len(_WHOLE) + 1]
    if len(own) < len(_WHOLE) or not _TALL[0] < own[0] < _TALL[1]:
        return 0.0
    apart = np.log(own / _WHOLE)
    return float(np.abs(apart - apart.mean()).mean())
