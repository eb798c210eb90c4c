"""Whether a body looks as if its skin had grown together: by the lowest eigenvalues of its surface.

Each end of a body that is free has low frequencies of its own; an arm that has grown together with the trunk has none.
So they tell of webs, too, which are no handles, and do not depend on the pose.
"""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray

# λ_2 to λ_7, means over 190 whole bodies of unit area (MakeHuman builds, FAUST, TOSCA): five ends make four low ones.
_WHOLE = np.array([6.1, 10.2, 14.2, 18.9, 36.2, 39.8])
ENOUGH = 7  # eigenvalues that have to be known
_TALL = (3.5, 10.5)  # λ_2 of bodies as tall for their skin as humans: on four legs it is 11 to 22
SUSPECT = 0.112  # unlikeness above which skin of a human may have grown together: whole ones have at most .108
SUSPECT_BESIDE = 0.13  # by how much eigenvalues are raised beside those of another pose: of one that is whole by .1


def is_tall(eigenvalues: FloatArray) -> bool:
    """Tell whether a body is as tall for its skin as humans are. `eigenvalues` (k,): λ_1, λ_2, … at unit area."""
    return len(eigenvalues) > len(_WHOLE) and bool(_TALL[0] < eigenvalues[1] < _TALL[1])


def unlike_whole_human(eigenvalues: FloatArray) -> float:
    """Measure how unlike the lowest eigenvalues of a body are those of a human one that is whole, whatever its size.

    `eigenvalues` (k,): λ_1, λ_2, … of the surface scaled to unit area; gives the mean deviation of their logarithms, 0
    for a body that is not as tall as a human one.

    Examples
    --------
    >>> unlike_whole_human(np.array([3.7, 5.6, 9.2, 13.3, 18.0, 34.1, 37.1])) < SUSPECT  # a man
    True
    >>> unlike_whole_human(np.array([4.3, 5.7, 18.7, 31.2, 31.6, 35.3, 56.8])) > SUSPECT  # with his hands on his belly
    True

    References
    ----------
    Reuter, Wolter and Peinecke, "Laplace-Beltrami spectra as 'Shape-DNA' of surfaces and solids", 2006,
    doi:10.1016/j.cad.2005.10.011.
    """
    if not is_tall(eigenvalues):
        return 0.0
    apart = np.log(eigenvalues[1 : len(_WHOLE) + 1] / _WHOLE)
    return float(np.abs(apart - apart.mean()).mean())


def raised(eigenvalues: FloatArray, others: FloatArray) -> float:
    """Measure by how much the lowest eigenvalues of a body lie above those of another, in any pose.

    `eigenvalues` (k,), `others` (k',): λ_1, λ_2, … of both, at unit area; gives the mean of the logarithms of their
    ratios, of the lowest six; 0 where they do not lie above, or fewer are known.

    Examples
    --------
    >>> round(raised(np.full(6, np.e), np.ones(6)), 6), raised(np.ones(6), np.full(6, 2.0))
    (1.0, 0.0)
    """
    count = len(_WHOLE)
    if min(len(eigenvalues), len(others)) < count:
        return 0.0
    return max(float(np.log(eigenvalues[:count] / others[:count]).mean()), 0.0)
