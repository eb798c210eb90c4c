"""Entry point for the mannequin: a human body in a T-pose or an A-pose, made of simple solids."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.ramps import smooth_ramp
from ..run.errors import InvalidSettingsError
from .body_plan import SHOULDER, human
from .solids import smooth_union
from .surface_nets import surface_net

T_POSE, A_POSE = 0.0, 45.0  # degrees
VERTEX_COUNT = 30_346  # of a mannequin

_STEP, _BLEND = 0.009, 0.007  # grid spacing, and width over which solids are blended, in metres
_LIFTED = 90.0  # degrees: the arms cannot be raised or lowered further
_SHOULDER_WIDTH, _SHOULDER_HEIGHT = (0.11, 0.22), (1.28, 1.36)  # metres: where the rotation of an arm sets in


def mannequin(arms: float = T_POSE) -> tuple[FloatArray, IntArray]:
    """Build a mannequin: an adult body, standing upright, legs straight.

    Parameters
    ----------
    arms : float
        How far the arms are lowered from the horizontal, in degrees, -90 to 90: 0 is a T-pose, 45 an A-pose.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions in metres. It faces negative Y and stands on Z = 0.
    faces : (m, 3) ndarray of int
        Triangles, the same for every pose.

    Raises
    ------
    InvalidSettingsError
        If the angle is out of bounds.

    Examples
    --------
    >>> vertices, faces = mannequin()
    >>> np.ptp(vertices, axis=0).round(1).tolist()
    [1.7, 0.3, 1.8]
    """
    if not -_LIFTED <= arms <= _LIFTED:
        raise InvalidSettingsError("mannequin_arms", value=arms)
    solids = human()
    low = np.min([solid.bounds()[0] for solid in solids], axis=0) - 3 * _STEP
    high = np.max([solid.bounds()[1] for solid in solids], axis=0) + 3 * _STEP
    half = int(np.ceil(high[0] / _STEP))
    across = (np.arange(2 * half) - half + 0.5) * _STEP  # symmetric about 0
    axes = (across, np.arange(low[1], high[1], _STEP), np.arange(low[2], high[2], _STEP))
    vertices, faces = surface_net(smooth_union(solids, axes, _BLEND), axes)
    vertices[:, 2] -= vertices[:, 2].min()
    return _with_arms_lowered(vertices, np.radians(arms)), faces


def _with_arms_lowered(points: FloatArray, angle: float) -> FloatArray:
    """Rotate the arms about the shoulders, less towards the trunk."""
    x, y, z = points.T
    share = smooth_ramp(np.abs(x), *_SHOULDER_WIDTH) * smooth_ramp(z, *_SHOULDER_HEIGHT)
    cos, sin = np.cos(share * angle), np.sin(share * angle)
    out, up = np.abs(x) - SHOULDER[0], z - SHOULDER[2]
    return np.column_stack([np.sign(x) * (SHOULDER[0] + cos * out + sin * up), y, SHOULDER[2] + cos * up - sin * out])
