"""Eigenfunctions of a body as they were if its parts had the areas of another's."""

import numpy as np
import pytest

from addon.core.matching.conformal_metric import with_areas_of
from addon.core.run.monitor import Monitor
from tests.meshes import shapes


@pytest.fixture(scope="module")
def inverted(gathered):
    """The same body after an inversion, a conformal map: the limbs near its centre are larger."""
    vertices, faces = shapes.figure(15)
    away = shapes.unit(vertices, faces) - [2.0, 0, 0]
    return gathered(away / (away**2).sum(axis=1, keepdims=True), faces)


def apart(one, other, count):
    """The share of the lowest eigenfunctions of one that lies outside the span of the other's."""
    waves, others = (np.sqrt(one.areas)[:, None] * each.eigenvectors[:, :count] for each in (one, other))
    spanned = others @ np.linalg.lstsq(others, waves, rcond=None)[0]
    return float(((waves - spanned) ** 2).sum() / (waves**2).sum())


def test_after_a_conformal_map_the_eigenfunctions_are_those_of_the_other(body, inverted):
    every = np.arange(len(body.form))
    ratio = inverted.areas / body.areas
    assert ratio.max() > 5 * ratio.min()
    scaled = with_areas_of(body, inverted, every, Monitor())
    for count in (5, 10):
        assert apart(scaled, inverted, count) < 0.01 * apart(body, inverted, count)
    np.testing.assert_allclose(
        scaled.eigenvectors.T @ (scaled.areas[:, None] * scaled.eigenvectors), np.eye(120), atol=1e-6
    )


def test_a_map_onto_itself_changes_nothing(body):
    same = with_areas_of(body, body, np.arange(len(body.form)), Monitor())
    np.testing.assert_allclose(same.areas, body.areas, rtol=1e-9)
    assert apart(same, body, 10) < 1e-9


def test_where_a_map_collapses_areas_stay_positive(body):
    most = np.zeros(len(body.form), dtype=int)
    most[::3] = np.arange(len(body.form))[::3]
    scaled = with_areas_of(body, body, most, Monitor())
    assert scaled.areas.sum() == pytest.approx(1.0)
    assert scaled.areas.min() > 0
    assert np.isfinite(scaled.eigenvectors).all()
