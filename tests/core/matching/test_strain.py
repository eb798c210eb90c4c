"""By how much a match strains the form."""

import numpy as np
import pytest

from addon.core.matching import strain as module
from addon.core.matching.sides import sides
from addon.core.matching.starts import Start
from addon.core.matching.strain import fit_strain
from addon.core.mesh.edges import vertex_pairs
from addon.core.modelling.mannequins import mannequin
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor
from tests.meshes import shapes

UNMATCHED = np.full(1, -1)
HALF_TURN = np.diag([-1.0, -1, 1])


@pytest.fixture(scope="module")
def human(gathered):
    """The mannequin, and the same one shorter, with longer arms."""
    vertices, faces = mannequin()
    return gathered(vertices, faces), gathered(vertices * [1.15, 1, 0.9], faces)


def start_from(one, other, rotation):
    """Start by placing a form by a rotation about the centre, without feature points."""
    return Start(np.full(len(one.features), -1), rotation, other.form.mean(axis=0) - one.form.mean(axis=0) @ rotation)


def test_a_body_moved_as_a_whole_is_not_strained(body, renumbered):
    other, _ = renumbered
    assert fit_strain(body, other, sides(body, other, Monitor())[0].start, Monitor()) < 1e-4


def test_a_human_turned_back_to_front_is_strained_more(human):
    one, other = human
    right, wrong = (fit_strain(one, other, start_from(one, other, turn), Monitor()) for turn in (np.eye(3), HALF_TURN))
    assert 0.02 < right < 0.1
    assert wrong > 1.2 * right


def test_strain_is_the_mean_logarithm_of_the_edges(body, monkeypatch):
    rng = np.random.default_rng(3)
    placed = body.form + 0.01 * rng.normal(size=body.form.shape)
    monkeypatch.setattr(module, "elastic_fit", lambda *found: (placed, found[3]))
    edges = vertex_pairs(body.faces)
    before, after = (np.linalg.norm(at[edges[:, 0]] - at[edges[:, 1]], axis=1) for at in (body.form, placed))
    strain = fit_strain(body, body, Start(UNMATCHED, np.eye(3), np.zeros(3)), Monitor())
    assert strain == pytest.approx(np.abs(np.log(after / before)).mean())


def test_edges_that_vanish_count_as_a_thousandth(body, monkeypatch):
    monkeypatch.setattr(module, "elastic_fit", lambda *found: (0 * body.form, found[3]))
    strain = fit_strain(body, body, Start(UNMATCHED, np.eye(3), np.zeros(3)), Monitor())
    assert strain == pytest.approx(np.log(1000))


def test_it_can_be_cancelled(body):
    start = Start(UNMATCHED, np.eye(3), np.zeros(3))
    with pytest.raises(CancelledError):
        fit_strain(body, body, start, Monitor(cancelled=lambda: True))


def test_a_small_sphere_has_a_strain(gathered):
    ball = gathered(*shapes.sphere(1))
    start = Start(np.full(len(ball.features), -1), np.eye(3), np.zeros(3))
    assert fit_strain(ball, ball, start, Monitor()) < 1e-6
