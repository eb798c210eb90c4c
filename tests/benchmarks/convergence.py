"""How far the sampled solution is from the full one: the stress of both on all pairs."""

import numpy as np

import addon.core.canonical as pipeline
from addon.core import Settings, canonical_form


def stress_ratio(vertices, faces):
    """Solve once with samples and once with all pairs from the same start; the stress on all pairs, one over the other.

    The mesh is not coarsened, so that both work on the same vertices.
    """
    caught = {}

    def catching(stress, inverse, start, iterations, tolerance, extrapolation, monitor):
        form, history = original(stress, inverse, start, iterations, tolerance, extrapolation, monitor)
        caught[bool(stress.cross)] = (stress, start, form, history, inverse, monitor)
        return form, history

    original = pipeline.minimise_stress
    pipeline.minimise_stress = catching
    worth = pipeline._WORTH_COARSENING
    pipeline._WORTH_COARSENING = 1e9
    try:
        canonical_form(vertices, faces, Settings(tolerance=1e-5))
        canonical_form(vertices, faces, Settings(quality="full", tolerance=1e-5))
    finally:
        pipeline.minimise_stress = original
        pipeline._WORTH_COARSENING = worth
    full, _, form, history, inverse, monitor = caught[False]
    _, start, sampled, _, _, _ = caught[True]
    _, from_same = original(full, inverse, start, 1000, 1e-7, 6, monitor)
    np.testing.assert_allclose(history[-1], full.value(form))
    return full.value(sampled) / from_same[-1]
