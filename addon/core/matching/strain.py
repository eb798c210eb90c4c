"""The strain of a match: by how much it changes lengths on the form."""

from __future__ import annotations

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..measures.form_measures import edge_stretch
from ..run.monitor import Monitor
from .elastic_fit import elastic_fit
from .spectral_map import first_map, on_triangles, refined
from .starts import Start
from .unfolded import Unfolded

_COUNTS, _LAST = (20, 35, 50), 80  # eigenfunctions, round by round, and in the last one
_NEAR = 0.3  # weight of positions on the form
_LEAST = 1e-3  # change of length below which it makes no difference


def fit_strain(one: Unfolded, other: Unfolded, start: Start, monitor: Monitor) -> float:
    """Fit a form to another from the start of a match, and measure its strain.

    `one, other`: the surfaces; `start`: the alignment of the forms, and the corresponding feature points.
    """
    body = ElasticBody(one.found.stiffness, one.found.mass, one.form, one.faces)
    partner = refined(one, other, first_map(one, other, start, monitor), _COUNTS, _NEAR, monitor)
    there = on_triangles(one, other, partner, _LAST, _NEAR, monitor)
    placed, _ = elastic_fit(body, one, other, there, monitor)
    change = edge_stretch(one.form, placed, one.faces)
    return float(np.abs(np.log(np.maximum(change, _LEAST))).mean())
