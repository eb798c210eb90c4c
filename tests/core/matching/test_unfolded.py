"""What tells the points of a surface apart."""

import numpy as np
import pytest

from addon.core.matching import unfolded as module
from addon.core.matching.unfolded import _mean_curvature, unfolded
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor
from addon.core.surface.spectrum import compute_spectrum
from tests.meshes import shapes


@pytest.fixture(scope="module")
def ball(gathered):
    return gathered(*shapes.sphere(3))


def test_areas_are_shares_and_eigenfunctions_orthonormal_under_them(body):
    assert body.areas.sum() == pytest.approx(1.0)
    products = body.eigenvectors.T @ (body.areas[:, None] * body.eigenvectors)
    np.testing.assert_allclose(products, np.eye(products.shape[0]), atol=1e-8)
    assert body.eigenvectors.shape[1] == 120
    np.testing.assert_allclose(body.areas @ body.eigenvectors, 0, atol=1e-8)  # the constant one is none of them


def test_a_ball_bulges_alike_everywhere_and_has_its_normals_outward(ball):
    radius = 1 / np.sqrt(4 * np.pi)
    np.testing.assert_allclose(ball.curvature, 0, atol=0.01 / radius)
    assert ball.areas @ _mean_curvature(ball.found) == pytest.approx(1 / radius, rel=0.02)
    centred = ball.form - ball.areas @ ball.form
    assert np.einsum("ij,ij->i", ball.normals, centred).min() > 0.95 * radius


def test_curvature_is_above_zero_on_tips_and_smoother_in_the_first_column(body):
    assert body.curvature[body.features].min() > np.median(body.curvature)
    wide, narrow = (body.areas @ (column - body.areas @ column) ** 2 for column in body.curvature.T)
    assert 0.1 * narrow < wide < narrow
    assert np.quantile(body.curvature[:, 1] - body.curvature[:, 0], [0, 1]).round(9).tolist() != [0, 0]


def test_curvature_is_that_of_the_pose_projected_onto_eigenfunctions(body):
    found = body.found
    bulge = np.einsum("ij,ij->i", found.stiffness @ found.surface.points, body.normals) / (2 * found.mass)
    kept = np.clip(bulge, *np.quantile(bulge, [0.02, 0.98]))
    for column, count in zip(body.curvature.T, (40, 80), strict=True):
        waves = body.eigenvectors[:, :count]
        fitted = np.linalg.lstsq(np.sqrt(body.areas)[:, None] * waves, np.sqrt(body.areas) * kept, rcond=None)[0]
        np.testing.assert_allclose(column, waves @ fitted, atol=1e-6)


def test_the_signature_is_that_of_the_waves_energy_by_energy(body):
    found = body.found
    spectrum = compute_spectrum(found.stiffness, found.mass, 120, Monitor())
    values = np.log(np.maximum(spectrum.eigenvalues[:80], np.finfo(float).tiny))
    levels = np.linspace(values[0], values[-1], 40)
    width = 7 * (values[-1] - values[0]) / 40
    for column, level in zip(body.signature.T, levels, strict=True):
        share = np.exp(-((level - values) ** 2) / (2 * width**2))
        energy = (body.eigenvectors[:, :80] ** 2 * share).sum(axis=1) / share.sum()
        np.testing.assert_allclose(column, np.log(energy) / np.sqrt(40), atol=1e-6)


def test_what_was_found_is_handed_on(body):
    assert body.limbs is body.found.limbs
    assert body.limbs is body.found.limbs
    np.testing.assert_array_equal(body.form, body.whole_form[body.found.surface.kept])


def test_more_eigenpairs_are_computed_where_there_are_too_few_and_that_can_be_cancelled(body):
    few = body.found.spectrum
    assert len(few.eigenvalues) < 120
    with pytest.raises(CancelledError):
        unfolded(body.found, body.found.whole_points, Monitor(cancelled=lambda: True))


def test_a_spectrum_that_is_whole_is_not_computed_again(gathered, monkeypatch):
    small = gathered(*shapes.sphere(1))
    assert len(small.found.spectrum.eigenvalues) == len(small.form) - 1
    monkeypatch.delattr(module, "compute_spectrum")
    assert unfolded(small.found, small.whole_form, Monitor()).eigenvectors.shape == (42, 41)
