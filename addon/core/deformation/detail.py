"""The detail pass: the input deformed towards the form, so that the detail of its surface is kept."""

from __future__ import annotations

from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .elastic_body import ElasticBody

_PULL = 17.0  # 1/area, where detail and form weigh the same
_LEAST_PULL = 0.3
_STEPS = 8
_FIRST = 12.0  # times the pull of the first pass, which only smooths what the stress crumpled
_FIRST_STEPS = 4
_FIRST_BENDING_WEIGHT = 0.6
_RELAXING_PULL = 200.0  # 1/area: lengths are restored and no limb is moved


def detailed(
    body: ElasticBody, form: FloatArray, preserve: float, monitor: Monitor, *, pull_share: float = 1.0
) -> FloatArray:
    """Deform the input towards the form and keep the detail of its surface.

    Parameters
    ----------
    body : ElasticBody
        The input; if it is closed, its compactness is kept too.
    form : (n, 3) ndarray of float
        The form that the stress asks for.
    preserve : float
        Above 0, which would be the form itself, to 1, as rigid as possible.
    monitor : Monitor
        Receives progress; polled for cancellation.
    pull_share : float
        Share of that pull towards the form which is used.

    Returns
    -------
    (n, 3) ndarray of float
        The form with the input's detail.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> import numpy as np
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> np.allclose(detailed(body, points, 0.5, Monitor()), points)
    True
    """
    pull = pull_share * max(_PULL * ((1 - preserve) / preserve) ** 2, _LEAST_PULL)
    bending_weight = preserve**5
    smooth = body.deformed_towards(
        form,
        pull=_FIRST * pull,
        steps=_FIRST_STEPS,
        bending_weight=max(bending_weight, _FIRST_BENDING_WEIGHT),
        monitor=monitor,
        share=0.3,
    )
    return body.deformed_towards(
        smooth,
        pull=pull,
        steps=_STEPS,
        bending_weight=bending_weight,
        monitor=monitor,
        pressure=True,
        yielding=True,
        done=0.3,
        share=0.7,
    )


def relaxed(body: ElasticBody, form: FloatArray, steps: int, monitor: Monitor, *, pressure: bool = False) -> FloatArray:
    """Mend the lengths of edges in a form whose limbs are where they belong.

    Parameters
    ----------
    body : ElasticBody
        The input.
    form : (n, 3) ndarray of float
        The form.
    steps : int
        Number of steps.
    monitor : Monitor
        Polled for cancellation.
    pressure : bool
        Whether the compactness of a closed input is kept too.

    Returns
    -------
    (n, 3) ndarray of float
        The form with the lengths of the input as far as these steps restore them.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> import numpy as np
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> np.allclose(relaxed(body, points, 2, Monitor()), points)
    True
    """
    return body.deformed_towards(
        form,
        pull=_RELAXING_PULL,
        steps=steps,
        bending_weight=_FIRST_BENDING_WEIGHT,
        monitor=monitor,
        pressure=pressure,
        done=1.0,
        share=0.0,
    )
