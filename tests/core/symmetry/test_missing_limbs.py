"""What is missing among the limbs of a body is said."""

import numpy as np
import pytest

from addon.core import Settings, feature_patches
from tests.meshes import shapes

TRUNK = ((0, 0, -0.7), (0, 0, 0.9))
HEAD = ((0, 0, 0.9), (0, 0, 2.2))
ARMS = [((0, 0, 0.8), (side * 2.6, 0, 0.9)) for side in (1, -1)]
LEGS = [((side * 0.1, 0, -0.6), (side * 0.9, 0, -3.2)) for side in (1, -1)]
TAIL = ((0, 0, -0.6), (0, 2.5, -0.8))
HORN = ((0, 0, 0.2), (0.3, -2.4, 0.6))
KINDS = {"no_pairs", "one_pair", "no_head", "unpaired_ends"}


def told(*limbs, **options):
    """The kinds of what is said about the limbs of a body with these limbs."""
    low, high = np.array([-3.2, -3.2, -3.8]), np.array([3.2, 3.2, 2.9])
    mesh = shapes.limbed([(TRUNK, 0.5), *((limb, 0.35) for limb in limbs)], low, high, 40)
    return {each.kind for each in feature_patches(*mesh, Settings(**options)).warnings} & KINDS


@pytest.mark.parametrize(
    ("limbs", "kinds"),
    [
        ((HEAD, *ARMS, *LEGS), set()),
        ((HEAD, *ARMS, *LEGS, TAIL), set()),
        ((*ARMS, *LEGS), {"no_head"}),
        ((HEAD, *ARMS), {"one_pair"}),
        ((HEAD, *ARMS, *LEGS, TAIL, HORN), {"unpaired_ends"}),
    ],
)
def test_it_is_said_what_is_missing(limbs, kinds):
    assert told(*limbs) == kinds


def test_a_missing_arm_is_said():
    assert told(HEAD, *LEGS, ARMS[0])  # the other may be paired with the head


def test_nothing_is_said_about_points_that_the_user_wanted():
    assert told(HEAD, *ARMS, feature_count=4) == set()
    assert told(HEAD, *ARMS, feature_points=(0, 99)) == set()
