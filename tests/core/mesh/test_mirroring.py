"""Half a mesh and its mirror images."""

import numpy as np
import pytest

from addon.core.mesh.edges import edge_table
from addon.core.mesh.geometry import surface_area
from addon.core.mesh.mirroring import Mirror, mirrored
from tests.meshes import shapes


@pytest.mark.parametrize("axes", [[0], [1, 2], [0, 1, 2]])
def test_the_images_close_the_surface(axes):
    grid = np.array([[x, y, 0.0] for y in range(4) for x in range(4)])
    corners = [4 * y + x for y in range(3) for x in range(3)]
    faces = np.array([[i, i + a, i + b] for i in corners for a, b in ((1, 5), (5, 4))])
    vertices = np.column_stack([grid[:, 0], grid[:, 1], (3 - grid[:, 0]) * (3 - grid[:, 1])])
    whole = mirrored(vertices, faces, [Mirror(axis, 1e-3) for axis in axes])
    assert len(whole.faces) == len(faces) * 2 ** len(axes)
    assert surface_area(whole.vertices, whole.faces) == pytest.approx(2 ** len(axes) * surface_area(vertices, faces))
    for image, axis in zip(whole.images, axes, strict=True):
        assert np.array_equal(image[image], np.arange(len(image)))
        signs = np.ones(3)
        signs[axis] = -1
        assert np.allclose(whole.vertices[image], whole.vertices * signs)
    assert np.allclose(np.abs(whole.vertices), np.abs(vertices[whole.source]))
    edges = edge_table(whole.faces)
    assert edges.count.max() <= 2  # sides agree, nothing lies twice
    assert len(np.unique(whole.faces)) == len(whole.vertices)


def test_a_shape_of_both_halves_is_made_symmetric():
    rng = np.random.default_rng(1)
    vertices, faces = shapes.figure(8)
    vertices = vertices - vertices.min(axis=0)
    mirrors = [Mirror(0, 0.2), Mirror(1, 0.2)]
    whole = mirrored(vertices, faces, mirrors)
    shape = whole.symmetrised(whole.vertices + 0.1 * rng.normal(size=whole.vertices.shape))
    for image, axis in zip(whole.images, (0, 1), strict=True):
        signs = np.ones(3)
        signs[axis] = -1
        assert np.allclose(shape[image], shape * signs)
        assert not shape[image == np.arange(len(image)), axis].any()  # in the mirror, to the bit
    assert np.allclose(whole.spread(shape[: len(vertices)]), shape)


def test_without_merging_every_vertex_has_an_image():
    vertices, faces = shapes.sphere(1)
    whole = mirrored(vertices, faces, [Mirror(2, -1.0)])
    assert len(whole.vertices) == 2 * len(vertices)
