"""The detail of the input on the form: the last deformation, and the way back from the coarse mesh to the fine one."""

from __future__ import annotations

import numpy as np

from .coarsening import Coarsening
from .deformation import deformed_towards, local_rotations, right_side_out
from .monitor import Monitor
from .surface import FloatArray, IntArray, Triangulation, is_closed

_PULL = 40.0  # 1/area, where detail and form weigh the same
_LEAST_PULL = 0.3
_STEPS = 8
_FIRST = 12.0  # times the pull of the first pass, which only smooths what the stress crumpled
_FIRST_STEPS = 4
_FIRST_MEMORY = 0.6
_POCKET_SPREAD = 0.001  # share of the area around a pocket that is let go


def detailed(
    surface: Triangulation,
    points: FloatArray,
    form: FloatArray,
    faces: IntArray,
    preserve: float,
    monitor: Monitor,
) -> FloatArray:
    """Deform the input towards the form, so that the detail of its surface is kept.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay.
    points : (n, 3) ndarray of float
        The input.
    form : (n, 3) ndarray of float
        The form that the stress asks for.
    faces : (m, 3) ndarray of int
        Triangles of the mesh; if it is closed, its compactness is kept too.
    preserve : float
        Above 0, which would be the form itself, to 1, as rigid as possible.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    (n, 3) ndarray of float
        The form with the input's detail.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    pull = max(_PULL * ((1 - preserve) / preserve) ** 2, _LEAST_PULL)
    memory = preserve**5
    closed = faces if is_closed(faces) else None
    smooth = deformed_towards(
        surface, points, form, _FIRST * pull, _FIRST_STEPS, max(memory, _FIRST_MEMORY), monitor=monitor, share=0.3
    )
    trust = right_side_out(surface, points, smooth, faces, _POCKET_SPREAD)
    return deformed_towards(surface, points, smooth, pull, _STEPS, memory, closed, monitor, trust, done=0.3, share=0.7)


def carried_by_frames(
    coarse: Coarsening, surface: Triangulation, points: FloatArray, form: FloatArray, fine_points: FloatArray
) -> FloatArray:
    """Carry the form of a coarse mesh to the fine one: every vertex moves with the frames around it.

    Parameters
    ----------
    coarse : Coarsening
        The coarse mesh among the fine vertices.
    surface : Triangulation
        The coarse surface, Delaunay.
    points, form : (c, 3) ndarray of float
        Coarse vertices of the input and of the form.
    fine_points : (n, 3) ndarray of float
        All vertices of the input.

    Returns
    -------
    (n, 3) ndarray of float
        All vertices of the form.

    References
    ----------
    Sumner, Schmid and Pauly, "Embedded Deformation for Shape Manipulation", 2007.
    """
    rotation = local_rotations(surface, points, form)
    shift = form - np.einsum("ij,ijk->ik", points, rotation)
    motion = coarse.carried_back(np.column_stack([rotation.reshape(-1, 9), shift]))  # (n, 12)
    return np.einsum("ij,ijk->ik", fine_points, motion[:, :9].reshape(-1, 3, 3)) + motion[:, 9:]
