"""The start of the minimisation."""

import numpy as np
import pytest

from addon.core.distances.heat import HeatMethod
from addon.core.distances.spectral import GreensFunction
from addon.core.embedding.start import input_start
from addon.core.surface.laplacian import mass, stiffness
from tests.meshes.shapes import prepared


def test_the_start_from_the_input_wants_biharmonic_distances_in_the_measure_of_geodesic_ones(figure):
    points, surface = prepared(*figure)
    green = GreensFunction(stiffness(surface), mass(surface))
    features = np.array([3, 50, 200, 400])
    to_features = HeatMethod(surface, 0.005, refine=False).distances(features)
    start = input_start(points, features, to_features, green, np.ones(len(points)))
    assert start.points is points
    assert start.depth == 1.0
    assert start.landmarks is features
    assert start.between is not None
    wanted, geodesic = start.between.targets[0], to_features[features]
    scales = wanted[np.triu_indices(4, 1)] / green.biharmonic_distances(features)[np.triu_indices(4, 1)]
    np.testing.assert_allclose(scales, scales[0])
    assert np.vdot(wanted, geodesic) == pytest.approx(np.vdot(wanted, wanted))  # least squares
    alone = input_start(points, features[:1], to_features[:, :1], green, np.ones(len(points)))
    assert (alone.between, alone.share, alone.depth) == (None, 0.0, 1.0)
