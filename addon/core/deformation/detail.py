"""The detail of the input on the form: the last deformation, and the way back from the coarse mesh to the fine one."""

from __future__ import annotations

import numpy as np

from ..mesh.coarsening import Coarsening
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .elastic_body import ElasticBody

_PULL = 17.0  # 1/area, where detail and form weigh the same
_LEAST_PULL = 0.3
_STEPS = 8
_FIRST = 12.0  # times the pull of the first pass, which only smooths what the stress crumpled
_FIRST_STEPS = 4
_FIRST_MEMORY = 0.6


def detailed(body: ElasticBody, form: FloatArray, preserve: float, monitor: Monitor) -> FloatArray:
    """Deform the input towards the form, so that the detail of its surface is kept.

    Parameters
    ----------
    body : ElasticBody
        The input; if it is closed, its compactness is kept too.
    form : (n, 3) ndarray of float
        The form that the stress asks for.
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
    smooth = body.deformed_towards(form, _FIRST * pull, _FIRST_STEPS, max(memory, _FIRST_MEMORY), monitor, share=0.3)
    return body.deformed_towards(smooth, pull, _STEPS, memory, monitor, pressure=True, done=0.3, share=0.7)


def carried_by_frames(coarse: Coarsening, body: ElasticBody, form: FloatArray, fine_points: FloatArray) -> FloatArray:
    """Carry the form of a coarse mesh to the fine one: every vertex moves with the frames around it.

    Parameters
    ----------
    coarse : Coarsening
        The coarse mesh among the fine vertices.
    body : ElasticBody
        The coarse mesh as a body.
    form : (c, 3) ndarray of float
        Coarse vertices of the form.
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
    rotation, shift = body.frames(form)
    motion = coarse.carried_back(np.column_stack([rotation.reshape(-1, 9), shift]))  # (n, 12)
    return np.einsum("ij,ijk->ik", fine_points, motion[:, :9].reshape(-1, 3, 3)) + motion[:, 9:]
