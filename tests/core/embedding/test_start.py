"""The intrinsic start, and the qualities."""

import numpy as np
import pytest

from addon.core.distances.farthest_points import farthest_points
from addon.core.distances.heat import HeatMethod
from addon.core.distances.spectral import GreensFunction
from addon.core.embedding.start import handedness, input_start, laid_out, landmark_distances
from addon.core.measures.alignment import rigid_fit
from addon.core.run.monitor import Monitor
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from tests.meshes import shapes
from tests.meshes.shapes import prepared


def layout_of(vertices, faces):
    points, surface = prepared(vertices, faces)
    spectrum = compute_spectrum(stiffness(surface), mass(surface), 60)
    heat = HeatMethod(surface, 0.005, refine=False)
    landmarks, distances = farthest_points(heat, np.array([0]), heat.distances([0]), 60, monitor=Monitor())
    return laid_out(landmark_distances(distances, landmarks, spectrum), landmarks, points, faces)[0]


def test_handedness_tells_a_ball_from_a_tie():
    vertices, faces = shapes.sphere(4)
    assert handedness(vertices, faces) == pytest.approx(4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1.0, 1.0, -1.0], faces) == pytest.approx(-4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1.0, 1.0, 0.0], faces) == 0


def test_the_layout_is_outside_out_or_flat(figure):
    for vertices, faces in (shapes.sphere(4), figure):
        layout = layout_of(vertices, faces)
        assert handedness(layout, faces) >= 0
        inward = layout_of(vertices, faces[:, ::-1])  # a mesh whose triangles face inwards
        turn, shift = rigid_fit(inward, layout)
        assert np.abs(inward @ turn + shift - layout).max() < 1e-6


def test_a_mirrored_mesh_has_the_mirrored_layout(figure):
    vertices, faces = figure
    layout = layout_of(vertices, faces)
    mirrored = layout_of(vertices * [-1, 1, 1], faces[:, ::-1])
    turn, shift = rigid_fit(mirrored, layout * [-1, 1, 1])
    assert np.abs(mirrored @ turn + shift - layout * [-1, 1, 1]).max() < 1e-6


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
