"""Bones in a T-pose: arms and legs straight, whatever the rest, and everything else as it was."""

import numpy as np
import pytest

from addon.core.rigging.limb_bones import limb_bones
from addon.core.rigging.stance import stance, swing
from tests.core.rigging.conftest import hand_drawn, turned_about_y


def stood(skeleton, pose="T", width=0.0):
    limbs = limb_bones(skeleton, np.eye(len(skeleton.names)))
    return limbs, stance(skeleton, limbs, pose, width)


def ways(skeleton, limbs, motions):
    """Directions of all segments after the motion, by limb."""
    found = {}
    for limb in limbs:
        segments = np.diff(limb.joints(skeleton), axis=0)
        turned = [motions.turns[bone] @ each for bone, each in zip(limb.bones, segments, strict=True)]
        found[limb.kind, limb.side] = [each / np.linalg.norm(each) for each in turned]
    return found


@pytest.mark.parametrize(
    "rest", [{}, {"elbow": 80, "knee": 40}, {"arms": -60, "spread": 40}, {"arms": 85, "elbow": 20}]
)
def test_arms_and_legs_become_straight(rest):
    skeleton = hand_drawn(**rest)
    limbs, motions = stood(skeleton)
    for (kind, side), segments in ways(skeleton, limbs, motions).items():
        for way in segments:
            if kind == "arm":
                assert np.allclose(way, [side, 0, 0])
            else:
                assert way[2] < -np.cos(np.radians(7))
                assert abs(way[1]) < 1e-9


def test_arms_of_an_a_pose_hang_by_45_degrees():
    skeleton = hand_drawn(arms=0)
    limbs, motions = stood(skeleton, "A")
    for (kind, side), segments in ways(skeleton, limbs, motions).items():
        if kind == "arm":
            assert np.allclose(segments, np.array([side, 0, -1]) / np.sqrt(2))


def test_joints_stay_joined_and_bones_as_long():
    skeleton = hand_drawn(elbow=80, knee=40, spread=30)
    _, motions = stood(skeleton)
    for bone, above in enumerate(skeleton.parents):
        if above >= 0:
            before = skeleton.heads[bone] - skeleton.heads[above]
            after = motions.heads[bone] - motions.heads[above]
            assert np.allclose(motions.turns[above] @ before, after)


def test_a_rig_that_stands_so_stays_as_it_is():
    skeleton = hand_drawn(arms=2, elbow=4, knee=8, spread=3)
    _, motions = stood(skeleton)
    assert np.allclose(motions.turns, np.eye(3), atol=1e-9)
    assert np.allclose(motions.heads, skeleton.heads)


def test_hands_go_with_forearms_and_feet_stay_flat():
    skeleton = hand_drawn(elbow=50, knee=40)
    _, motions = stood(skeleton)
    at = skeleton.names.index
    assert np.allclose(motions.turns[at("hand.L")], motions.turns[at("forearm.L")])
    assert np.allclose(motions.turns[at("foot.R")], np.eye(3))
    assert np.allclose(motions.turns[at("head")], np.eye(3))


@pytest.mark.parametrize("angle", [90.0, 180.0, 37.0, 25.0, 4.0])
def test_the_body_faces_the_front_however_it_stood(angle):
    skeleton = hand_drawn()
    cos, sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    away = skeleton._replace(heads=skeleton.heads @ turn.T, tails=skeleton.tails @ turn.T)
    (_, wanted), (_, found) = stood(skeleton), stood(away)
    assert np.allclose(found.turns @ turn, wanted.turns, atol=1e-9)


def test_a_body_that_leans_by_nature_is_not_set_straight():
    skeleton = hand_drawn()
    lean = turned_about_y(8)
    leaning = skeleton._replace(heads=skeleton.heads @ lean.T, tails=skeleton.tails @ lean.T)
    assert np.allclose(stood(leaning)[1].turns[skeleton.names.index("hips")], np.eye(3))


def test_a_body_whose_trunk_is_level_stays_on_its_feet():
    skeleton = hand_drawn(arms=80)
    cos, sin = np.cos(np.radians(85)), np.sin(np.radians(85))
    forward = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
    upper = [bone for bone, name in enumerate(skeleton.names) if not name.startswith(("thigh", "shin", "foot"))]
    heads, tails = skeleton.heads.copy(), skeleton.tails.copy()
    for ends in (heads, tails):
        ends[upper] = (ends[upper] - [0, 0, 1]) @ forward.T + [0, 0, 1]
    limbs, motions = stood(skeleton._replace(heads=heads, tails=tails))
    assert np.allclose(motions.turns[skeleton.names.index("hips")], np.eye(3))
    assert len(limbs) == 4


def test_wide_feet_stand_beside_each_other():
    skeleton = hand_drawn()
    at = skeleton.names.index
    for width in (0.0, 0.3):
        _, motions = stood(skeleton, width=width)
        apart = motions.heads[at("foot.L")] - motions.heads[at("foot.R")]
        assert apart[0] >= width
        assert abs(apart[2]) < 1e-9


def test_feet_on_targets_hang_on_their_shins():
    skeleton = hand_drawn(knee=40)
    at = skeleton.names.index
    loose = skeleton.parents.copy()
    loose[[at("foot.L"), at("foot.R")]] = -1
    _, motions = stood(skeleton._replace(parents=loose))
    _, wanted = stood(skeleton)
    assert np.allclose(motions.heads, wanted.heads)


def test_the_knee_of_an_animal_stays_folded():
    skeleton = hand_drawn(knee=100)
    _, motions = stood(skeleton)
    at = skeleton.names.index
    assert np.allclose(motions.turns[at("shin.L")], np.eye(3), atol=1e-9)


def test_opposed_directions_have_a_swing():
    assert np.allclose(swing(np.array([0, 0, 2.0]), np.array([0, 0, -1.0])) @ [0, 0, 1], [0, 0, -1])
