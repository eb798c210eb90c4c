"""A twisted trunk is measured, whatever the shape's position."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import canonical_form
from addon.core.symmetry.trunk_twist import TWISTED, trunk_twist
from tests.core.symmetry.test_missing_limbs import ARMS, HEAD, LEGS, TRUNK
from tests.meshes import shapes


@pytest.fixture(scope="module")
def form():
    low, high = np.array([-3.2, -1.2, -3.8]), np.array([3.2, 1.2, 2.9])
    limbs = [(TRUNK, 0.5), *((limb, 0.35) for limb in (HEAD, *ARMS, *LEGS))]
    return canonical_form(*shapes.limbed(limbs, low, high, 40))


@pytest.mark.parametrize("angle", [0, 30, 90, 150])
def test_it_is_the_angle_by_which_the_upper_body_is_turned(angle, form):
    body = form.bodies[0]
    tips = np.array([HEAD[1], ARMS[0][1], ARMS[1][1], LEGS[0][1], LEGS[1][1]], dtype=float)
    places = form.vertices[form.feature_points]
    assert body.limbs.side.tolist() == [0, 1, -1, 1, -1]
    turned = tips @ np.diag([np.sign(places[1, 0]), 1, 1])
    turned[:3] = Rotation.from_euler("z", angle, degrees=True).apply(turned[:3])
    anywhere = Rotation.from_euler("xyz", [20, 50, 130], degrees=True)
    assert trunk_twist(anywhere.apply(turned) + 5, body.limbs) == pytest.approx(angle, abs=1e-6)


def test_a_form_is_not_twisted_and_nothing_is_said(form):
    tips = form.vertices[form.feature_points]
    assert trunk_twist(tips, form.bodies[0].limbs) < 15 < TWISTED
    assert "twisted" not in [told.kind for told in form.warnings]


def test_a_form_that_is_twisted_says_so(monkeypatch, form):
    monkeypatch.setattr("addon.core.canonical.trunk_twist", lambda *_: 61.0)
    vertices, faces = form.vertices, form.faces
    assert "twisted" in [told.kind for told in canonical_form(vertices, faces).warnings]
