"""Arms and legs among the bones of a rig."""

import numpy as np
import pytest

from addon.core.rigging.limb_bones import limb_bones
from tests.core.rigging.conftest import hand_drawn


def told(skeleton, weights=None):
    limbs = limb_bones(skeleton, np.eye(len(skeleton.names)) if weights is None else weights)
    return {(limb.kind, limb.side): [*limb.bones, limb.end] for limb in limbs}


def test_names_tell_the_limbs():
    skeleton = hand_drawn()
    at = skeleton.names.index
    assert told(skeleton) == {
        (kind, side): [at(f"{name}.{letter}") for name in bones]
        for kind, bones in (("arm", ("upper_arm", "forearm", "hand")), ("leg", ("thigh", "shin", "foot")))
        for letter, side in (("L", 1), ("R", -1))
    }


@pytest.mark.parametrize("rest", [{}, {"arms": 0}, {"arms": 70, "spread": 10}])
def test_without_names_the_shape_tells_the_same(rest):
    skeleton = hand_drawn(**rest)
    nameless = skeleton._replace(names=[f"Bone.{number:03}" for number in range(len(skeleton.names))])
    found, wanted = told(nameless), told(skeleton)
    assert {limb: bones[:2] for limb, bones in found.items()} == {limb: bones[:2] for limb, bones in wanted.items()}


def test_control_bones_without_skin_are_no_limbs():
    skeleton = hand_drawn()
    count = len(skeleton.names)
    own = np.where(skeleton.parents < 0, -1, skeleton.parents + count)
    double = skeleton._replace(
        names=[*skeleton.names, *skeleton.names],
        parents=np.concatenate([skeleton.parents, own]),
        heads=np.vstack([skeleton.heads + 5, skeleton.heads]),
        tails=np.vstack([skeleton.tails + 5, skeleton.tails]),
    )
    weights = np.hstack([np.zeros((count, count)), np.eye(count)])
    assert all(bone >= count for bones in told(double, weights).values() for bone in bones)


def test_of_several_hands_the_one_at_the_end_of_the_arm_is_taken():
    skeleton = hand_drawn()
    arm = skeleton.names.index("forearm.L")
    more = skeleton._replace(
        names=["palm.L", *skeleton.names],
        parents=np.concatenate([[arm + 1], np.where(skeleton.parents < 0, -1, skeleton.parents + 1)]),
        heads=np.vstack([[-3.0, 0, 1], skeleton.heads]),
        tails=np.vstack([[-3.0, 0, 2], skeleton.tails]),
    )
    assert told(more)["arm", 1][-1] == more.names.index("hand.L")


def test_a_rig_without_arms_has_no_limbs():
    skeleton = hand_drawn()
    kept = [bone for bone, name in enumerate(skeleton.names) if "arm" not in name and "hand" not in name]
    number = {bone: index for index, bone in enumerate(kept)}
    less = skeleton._replace(
        names=[skeleton.names[bone] for bone in kept],
        parents=np.array([number.get(int(skeleton.parents[bone]), -1) for bone in kept]),
        heads=skeleton.heads[kept],
        tails=skeleton.tails[kept],
    )
    assert told(less) == {}


@pytest.mark.parametrize("aside", [5.0, -5.0])
def test_the_shape_tells_wherever_the_rig_stands(aside):
    skeleton = hand_drawn()
    nameless = skeleton._replace(
        names=[f"Bone.{number:03}" for number in range(len(skeleton.names))],
        heads=skeleton.heads + np.array([aside, 0, 0]),
        tails=skeleton.tails + np.array([aside, 0, 0]),
    )
    assert {limb: bones[:2] for limb, bones in told(nameless).items()} == {
        limb: bones[:2] for limb, bones in told(skeleton).items()
    }


def test_a_limb_without_its_partner_is_not_guessed_at():
    skeleton = hand_drawn()
    heads = skeleton.heads.copy()
    heads[skeleton.names.index("forearm.R")] += [0, 0.4, 0]
    nameless = [f"Bone.{number:03}" for number in range(len(skeleton.names))]
    assert told(skeleton._replace(names=nameless, heads=heads)) == {}


def test_a_limb_that_runs_from_the_foot_to_the_trunk_is_none():
    skeleton = hand_drawn()
    at = skeleton.names.index
    parents = skeleton.parents.copy()
    for side in "LR":
        thigh, shin, foot = (at(f"{name}.{side}") for name in ("thigh", "shin", "foot"))
        parents[thigh], parents[shin], parents[foot] = shin, foot, 0
    assert told(skeleton._replace(parents=parents)) == {}


def test_parents_in_a_circle_end():
    skeleton = hand_drawn()
    parents = skeleton.parents.copy()
    parents[0] = 1
    assert len(skeleton._replace(parents=parents).ancestors(1)) == 2
