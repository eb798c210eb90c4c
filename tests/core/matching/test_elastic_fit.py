"""A form moved onto another as rigidly as possible."""

import numpy as np
import pytest

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.matching.elastic_fit import elastic_fit
from addon.core.mesh.closest_points import closest_points
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor


def form_of(one):
    return ElasticBody(one.found.stiffness, one.found.mass, one.form, one.faces)


def errors(one, other, points, truth):
    return np.linalg.norm(points.on(other.form, other.faces) - other.form[truth], axis=1)


def test_the_exact_map_stays(body, renumbered):
    other, old = renumbered
    truth = np.argsort(old)
    exact = closest_points(other.form, other.faces, other.form[truth])
    placed, points = elastic_fit(form_of(body), body, other, exact, Monitor())
    np.testing.assert_allclose(placed, other.form[truth], atol=1e-9)
    assert errors(body, other, points, truth).max() < 1e-9


def test_a_map_that_slides_along_the_surface_is_drawn_back(body, renumbered):
    """Every vertex is sent some .03 away in a direction of its own: neighbours disagree, lengths do not allow it."""
    other, old = renumbered
    truth = np.argsort(old)
    astray = other.form[truth] + 0.03 * np.random.default_rng(0).normal(size=(len(truth), 3))
    wrong = closest_points(other.form, other.faces, astray)
    before = errors(body, other, wrong, truth)
    placed, points = elastic_fit(form_of(body), body, other, wrong, Monitor())
    after = errors(body, other, points, truth)
    assert before.mean() > 0.015
    assert after.mean() < before.mean() / 2
    edges = body.faces[:, :2]
    lengths = [np.linalg.norm(np.diff(each[edges], axis=1)[:, 0], axis=1) for each in (body.form, placed)]
    kept = np.median(np.abs(lengths[1] / lengths[0] - 1))
    torn = np.diff(wrong.on(other.form, other.faces)[edges], axis=1)[:, 0]
    assert kept < np.median(np.abs(np.linalg.norm(torn, axis=1) / lengths[0] - 1)) / 2


def test_the_fit_can_be_cancelled(body):
    same = closest_points(body.form, body.faces, body.form)
    with pytest.raises(CancelledError):
        elastic_fit(form_of(body), body, body, same, Monitor(cancelled=lambda: True))
