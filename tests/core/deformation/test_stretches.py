"""Stretches between covariances, and forms that give theirs back."""

import numpy as np
import pytest

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.deformation.stretches import stretch_between
from addon.core.mesh.geometry import surface_area
from addon.core.surface.laplacian import stiffness_and_mass
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def test_a_stretch_takes_one_covariance_to_the_other():
    rng = np.random.default_rng(0)
    roots = rng.normal(size=(2, 20, 3, 3))
    before, after = roots @ roots.transpose(0, 1, 3, 2) + 0.5 * np.eye(3)
    stretch = stretch_between(before, after)
    np.testing.assert_allclose(stretch, stretch.transpose(0, 2, 1), atol=1e-12)
    assert (np.linalg.eigvalsh(stretch) > 0).all()
    np.testing.assert_allclose(stretch @ before @ stretch, after, rtol=1e-8, atol=1e-8)


def test_flat_and_torn_covariances_have_bounded_stretches():
    flat = np.diag([1.0, 1.0, 0.0])[None]
    for before, after in ((flat, flat), (flat, np.eye(3)[None]), (1e12 * flat, flat), (flat, 1e12 * flat)):
        values = np.linalg.eigvalsh(stretch_between(before, after))
        assert np.isfinite(values).all()
        assert values.min() > 0.09
        assert values.max() < 10.1


@pytest.mark.parametrize("factor", [0.6, 1.0, 2.5])
def test_a_tube_pulled_long_and_turned_gets_its_length_back_and_keeps_its_direction(factor: float, rotation):
    vertices, faces = shapes.joint(0, radius=0.2)
    vertices = vertices / np.sqrt(surface_area(vertices, faces))
    body = ElasticBody(*stiffness_and_mass(triangulated(vertices, faces)), vertices, faces)
    pulled = (vertices * [factor, 1.0, 1.0]) @ rotation
    form = body.without_stretch(pulled, 0.05)
    assert np.ptp(form @ rotation.T[:, 0]) == pytest.approx(np.ptp(vertices[:, 0]), rel=0.05)
    np.testing.assert_allclose(np.ptp(form @ rotation.T, axis=0)[1:], np.ptp(vertices, axis=0)[1:], rtol=0.1)
