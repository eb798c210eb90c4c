"""How much a limb is bent, and how many limbs a form has straightened."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.vectors import angle

_LIMB = 0.8  # largest area of a limb over its squared length; heads and trunks have more
_END = 0.25  # share of a limb at either end
_MIDDLES = (0.35, 0.45, 0.55, 0.65)  # where the joint may be, as shares of the way from the tip,
_AROUND = 0.1  # and how far it extends: single rings of a coarse mesh lie askew
_BENT = 30.0  # degrees; an arm in a T-pose has up to 15


def limb_bends(points: FloatArray, mass: FloatArray, cells: IntArray, to_features: FloatArray) -> FloatArray:
    """Measure the angle by which each limb is bent at its joint, in degrees; nan where a patch is no limb.

    The joint is where the centres of the two ends and of a part between them make the largest angle.

    `points` (n, 3); `mass` (n,); `cells` (n,): patch of every vertex; `to_features` (n, k): distances that patches
    are made of; gives (k,).

    Examples
    --------
    >>> along = np.linspace(0.0, 2.0, 41)
    >>> bent = np.column_stack([np.minimum(along, 1.0), np.maximum(along - 1.0, 0.0), np.zeros(41)])
    >>> limb_bends(bent, np.full(41, 0.01), np.zeros(41, dtype=np.int64), along[:, None]).round().tolist()
    [79.0]
    """
    bends = np.full(to_features.shape[1], np.nan)
    for limb in range(len(bends)):
        own = np.flatnonzero(cells == limb)
        length = float(to_features[own, limb].max(initial=0.0))
        if length == 0 or mass[own].sum() > _LIMB * length**2:
            continue
        along = to_features[own, limb] / length
        parts = [along <= _END, along >= 1 - _END, *(np.abs(along - middle) < _AROUND for middle in _MIDDLES)]
        if not all(part.any() for part in parts):
            continue
        weight = np.array(parts) * mass[own]
        tip, root, *middles = weight @ points[own] / weight.sum(axis=1, keepdims=True)
        bends[limb] = max(angle(middle - tip, root - middle) for middle in middles)
    return bends


def bend_summary(bends: FloatArray) -> dict[str, float]:
    """Count the limbs that were bent, and those of them that were straightened, or by more than half.

    `bends` (k, 2): degrees in the pose and in the form; nan for what is no limb; gives the counts, and the mean angle
    of the bent limbs in both; nothing without limbs.

    Examples
    --------
    >>> bend_summary(np.array([[90.0, 20], [70, 60], [10, 10], [np.nan, np.nan]]))
    {'limbs_bent': 2.0, 'limbs_straightened': 1.0, 'bend_in_pose': 80.0, 'bend_in_form': 40.0}
    """
    if np.isnan(bends).all():
        return {}
    before, after = bends[bends[:, 0] > _BENT].T
    means = {"bend_in_pose": float(before.mean()), "bend_in_form": float(after.mean())} if len(before) else {}
    count = np.count_nonzero(after < np.maximum(_BENT, before / 2))
    return {"limbs_bent": float(len(before)), "limbs_straightened": float(count), **means}
