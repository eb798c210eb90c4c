"""Arms rolled about their own axes: hands lie the same way in the forms of all poses."""

import numpy as np
import pytest

from addon.core import canonical_form, mannequin
from addon.core.measures.alignment import rigid_fit
from addon.core.methods import local_features
from tests.meshes import shapes
from tests.meshes.shapes import Mesh

WRIST, SHOULDER, ELBOW = 0.66, 0.2, 0.5


@pytest.fixture(scope="module")
def handed() -> Mesh:
    """The mannequin, its thumbs lowered towards the palms as those of a body."""
    vertices, faces = mannequin()
    hand = np.clip((np.abs(vertices[:, 0]) - WRIST + 0.04) / 0.06, 0, 1)
    middle = vertices[hand == 1].mean(axis=0)
    vertices[:, 2] -= 0.8 * hand * np.maximum(middle[1] - vertices[:, 1] - 0.025, 0)
    return vertices, faces


def rolled(vertices: np.ndarray, degrees: float, side: int) -> np.ndarray:
    """Roll an arm by an angle that grows from the shoulder to the elbow."""
    along = side * vertices[:, 0]
    arm = along > SHOULDER
    centre = vertices[along > WRIST].mean(axis=0)
    angle = np.radians(degrees) * np.clip((along[arm] - SHOULDER) / (ELBOW - SHOULDER), 0, 1)
    y, z = (vertices[arm] - centre).T[1:]
    out = vertices.copy()
    out[arm, 1] = centre[1] + np.cos(angle) * y - np.sin(angle) * z
    out[arm, 2] = centre[2] + np.sin(angle) * y + np.cos(angle) * z
    return out


def turns(form: np.ndarray, other: np.ndarray, hands: list[np.ndarray]) -> list[float]:
    """Angles between the hands of two forms once the forms are aligned, degrees."""
    turn, _ = rigid_fit(form, other)
    found = [rigid_fit((form @ turn)[hand], other[hand])[0] for hand in hands]
    return [float(np.degrees(np.arccos(np.clip((np.trace(each) - 1) / 2, -1, 1)))) for each in found]


@pytest.mark.parametrize("degrees", [(110, 0), (-100, 100), (80, 80)])
def test_an_arm_rolled_in_the_pose_is_not_in_the_form(handed, degrees, monkeypatch):
    vertices, faces = handed
    hands = [side * vertices[:, 0] > WRIST for side in (1, -1)]
    posed = rolled(rolled(vertices, degrees[0], 1), degrees[1], -1)
    apart = turns(canonical_form(posed, faces).vertices, canonical_form(vertices, faces).vertices, hands)
    monkeypatch.setattr(local_features, "arms_rolled", lambda body, form, *rest: form)
    before = turns(canonical_form(posed, faces).vertices, canonical_form(vertices, faces).vertices, hands)
    assert max(apart) < 40
    assert max(before) > 90


def test_limbs_without_hands_stay(monkeypatch):
    vertices, faces = shapes.figure()
    form = canonical_form(vertices, faces).vertices
    monkeypatch.setattr(local_features, "arms_rolled", lambda body, form, *rest: form)
    assert np.array_equal(form, canonical_form(vertices, faces).vertices)
