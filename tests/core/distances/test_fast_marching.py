"""Fast marching, against what is known."""

import numpy as np

from addon.core.distances.fast_marching import fast_marching
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def test_fast_marching_on_a_plane_is_euclidean():
    vertices, faces = shapes.grid(41, 31, 4.0, 3.0)
    measured = fast_marching(triangulated(vertices, faces), np.array([0]))
    assert np.abs(measured - np.linalg.norm(vertices, axis=1)).max() < 0.03 * 5.0


def test_fast_marching_converges_on_a_sphere():
    errors = []
    for subdivisions in (3, 4, 5):
        vertices, faces = shapes.sphere(subdivisions)
        true = np.arccos(np.clip(vertices @ vertices[0], -1, 1))
        errors.append(np.abs(fast_marching(triangulated(vertices, faces), np.array([0])) - true).mean())
    assert errors[2] < 0.7 * errors[1] < 0.6 * errors[0]
