"""Handedness of functions on a surface."""

import numpy as np

from addon.core.symmetry.chirality import chirality
from tests.meshes import shapes


def test_the_coordinates_of_a_closed_surface_have_its_volume():
    vertices, faces = shapes.sphere(3)
    corners = vertices[faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert abs(chirality(vertices, faces)[0, 1, 2] - volume) < 1e-12
    assert abs(volume - 4 / 3 * np.pi) < 0.1


def test_it_changes_sign_with_the_order_of_the_functions_and_when_the_surface_is_mirrored(figure):
    vertices, faces = figure
    functions = np.random.default_rng(0).normal(size=(len(vertices), 4))
    one = chirality(functions, faces)
    np.testing.assert_allclose(one, one.transpose(1, 2, 0), atol=1e-12)
    np.testing.assert_allclose(one, -one.transpose(0, 2, 1), atol=1e-12)
    np.testing.assert_allclose(chirality(functions, faces[:, ::-1]), -one, atol=1e-12)
    assert np.abs(one).max() > 1e-3


def test_what_is_added_to_a_function_does_not_count():
    vertices, faces = shapes.sphere(3)
    np.testing.assert_allclose(
        chirality(vertices + np.array([7.0, -2, 3]), faces), chirality(vertices, faces), atol=1e-11
    )
