"""Limbs rolled about their own axes: hands and feet lie the same way in the forms of all poses."""

import numpy as np
import pytest

from addon.core import KeptStages, canonical_form, mannequin
from addon.core.measures.alignment import rigid_fit
from addon.core.methods import straight
from addon.core.symmetry import limb_rolls
from tests.meshes import animals, shapes
from tests.meshes.shapes import Mesh

WRIST, SHOULDER, ELBOW = 0.66, 0.2, 0.5
ANKLE, KNEE, HIP = 0.12, 0.45, 0.75


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


def leg_rolled(vertices: np.ndarray, degrees: float, side: int) -> np.ndarray:
    """Roll a leg by an angle that grows from the hip to the knee."""
    leg = (side * vertices[:, 0] > 0.002) & (vertices[:, 2] < HIP) & (np.abs(vertices[:, 0]) < 0.3)
    centre = vertices[leg & (vertices[:, 2] < KNEE)].mean(axis=0)
    angle = np.radians(degrees) * np.clip((HIP - vertices[leg, 2]) / (HIP - KNEE), 0, 1)
    x, y = (vertices[leg] - centre).T[:2]
    out = vertices.copy()
    out[leg, 0] = centre[0] + np.cos(angle) * x - np.sin(angle) * y
    out[leg, 1] = centre[1] + np.sin(angle) * x + np.cos(angle) * y
    return out


def turns(form: np.ndarray, other: np.ndarray, hands: list[np.ndarray]) -> list[float]:
    """Angles between the hands of two forms once the forms are aligned, degrees."""
    turn, _ = rigid_fit(form, other)
    found = [rigid_fit((form @ turn)[hand], other[hand])[0] for hand in hands]
    return [float(np.degrees(np.arccos(np.clip((np.trace(each) - 1) / 2, -1, 1)))) for each in found]


def with_and_without(posed: np.ndarray, mesh: Mesh, ends: list[np.ndarray], monkeypatch) -> tuple[float, float]:
    """The largest angle between the ends of limbs in the forms of two poses, with limbs rolled and without."""
    vertices, faces = mesh
    here, there = KeptStages(), KeptStages()  # all up to the detail is alike
    apart = []
    for _ in range(2):
        form = canonical_form(posed, faces, keep=here).vertices
        apart.append(max(turns(form, canonical_form(vertices, faces, keep=there).vertices, ends)))
        monkeypatch.setattr(straight, "limbs_rolled", lambda body, form, *rest: form)
    return apart[0], apart[1]


@pytest.mark.parametrize("degrees", [(110, 0), (-100, 100), (80, 80)])
def test_an_arm_rolled_in_the_pose_is_not_in_the_form(handed, degrees, monkeypatch):
    vertices, _ = handed
    hands = [side * vertices[:, 0] > WRIST for side in (1, -1)]
    posed = rolled(rolled(vertices, degrees[0], 1), degrees[1], -1)
    apart, before = with_and_without(posed, handed, hands, monkeypatch)
    assert apart < 20
    assert before > 30


@pytest.mark.parametrize("degrees", [(70, 0), (-60, 60), (50, 50)])
def test_a_leg_rolled_in_the_pose_is_not_in_the_form(degrees, monkeypatch):
    vertices, faces = mannequin()
    feet = [(vertices[:, 2] < ANKLE) & (side * vertices[:, 0] > 0) for side in (1, -1)]
    posed = leg_rolled(leg_rolled(vertices, degrees[0], 1), degrees[1], -1)
    apart, before = with_and_without(posed, (vertices, faces), feet, monkeypatch)
    assert apart < 25
    assert before > 40


def test_legs_of_a_deep_form_stay(monkeypatch):
    def asked(*_arguments):
        raise AssertionError("the legs of a deep form are measured")

    monkeypatch.setattr(limb_rolls, "_leg", asked)
    canonical_form(*animals.giraffe())
    with pytest.raises(AssertionError, match="deep"):
        canonical_form(*mannequin())


def test_toes_point_to_the_side_where_they_point_already():
    legs = [limb_rolls._Roll(np.ones(1), np.zeros(3), np.eye(3)[2], np.radians(angle), 1.0) for angle in (170, -130)]
    turned = limb_rolls._to_one_side(legs)
    np.testing.assert_allclose(np.degrees([each.angle for each in turned]), [-10, 50])
    assert [each.sure for each in turned] == [1, 1]
    across = limb_rolls._to_one_side([each._replace(angle=np.pi / 2) for each in legs])
    assert [each.sure for each in across] == [0, 0]


def test_limbs_without_hands_stay(monkeypatch):
    vertices, faces = shapes.figure()
    form = canonical_form(vertices, faces).vertices
    monkeypatch.setattr(straight, "limbs_rolled", lambda body, form, *rest: form)
    assert np.array_equal(form, canonical_form(vertices, faces).vertices)
