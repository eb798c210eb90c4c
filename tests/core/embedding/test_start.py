"""The intrinsic start, and the qualities."""

import numpy as np
import pytest

from addon.core.distances.farthest_points import farthest_points
from addon.core.distances.heat import HeatMethod
from addon.core.embedding.start import handedness, laid_out, landmark_distances
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
