"""Distance of the default from the minimum of its stress."""

from unittest import mock

import numpy as np

from addon.core import Settings, canonical_form
from addon.core.mesh.geometry import surface_area
from addon.core.methods import local_features


def stress_ratios(vertices, faces):
    """Solve on all vertices with the default tolerance and then to convergence, and compare the stresses.

    Returns the number of steps, the stress at the default tolerance, and the stress of the default form, which is
    solved on the coarse mesh, given its detail and interpolated to all vertices; both stresses relative to that of the
    solution converged from the same start.
    """
    caught = []

    def catching(*arguments, **options):
        caught.append((arguments, options, original(*arguments, **options)))
        return caught[-1][-1]

    original = local_features.minimise_stress
    with mock.patch.object(local_features, "minimise_stress", catching):
        canonical_form(vertices, faces, Settings(quality="full"))
    (stress, inverse, start), options, (_, history) = caught[0]
    options |= {"max_iterations": 2000, "tolerance": 1e-8, "extrapolation": 12}
    least = original(stress, inverse, start, **options)[1][-1]
    form = canonical_form(vertices, faces).vertices
    form /= np.sqrt(surface_area(form, faces))
    return len(history) - 1, history[-1] / least, stress.value(form) / least
