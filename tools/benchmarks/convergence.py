"""How far the default is from the minimum of its stress."""

from unittest import mock

import numpy as np

import addon.core.canonical as pipeline
from addon.core import Settings, canonical_form
from addon.core.mesh.geometry import surface_area


def stress_ratios(vertices, faces):
    """Solve on all vertices with the default tolerance and on from there to the end, and compare the stresses.

    Returns the stress where the default stops, and that of the form which the default gives, solved on its coarse
    mesh, given its detail and carried back; each over the stress of the full solver, converged from the same start.
    """
    caught = []

    def catching(*arguments):
        caught.append((arguments, original(*arguments)))
        return caught[-1][1]

    original = pipeline.minimise_stress
    with mock.patch.object(pipeline, "minimise_stress", catching):
        canonical_form(vertices, faces, Settings(quality="full"))
    (stress, inverse, start, _, _, _, monitor), (_, history) = caught[0]
    least = original(stress, inverse, start, 2000, 1e-8, 12, monitor)[1][-1]
    form = canonical_form(vertices, faces).vertices
    form /= np.sqrt(surface_area(form, faces))
    return len(history) - 1, history[-1] / least, stress.value(form) / least
