"""What bones are, in the spelling of those who make rigs."""

import pytest

from addon.core.rigging.bone_names import ROLES, read_bone_name, roles_of

SPELLINGS = {
    "Rigify": ["upper_arm.L", "forearm.L", "hand.L", "thigh.L", "shin.L", "foot.L"],
    "Rigify, deforming": ["DEF-upper_arm.L", "DEF-forearm.L", "DEF-hand.L", "DEF-thigh.L", "DEF-shin.L", "DEF-foot.L"],
    "Mixamo": [f"mixamorig:Left{name}" for name in ("Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot")],
    "Unreal": ["upperarm_l", "lowerarm_l", "hand_l", "thigh_l", "calf_l", "foot_l"],
    "VRM": [f"J_Bip_L_{name}" for name in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")],
    "Biped": [f"Bip01 L {name}" for name in ("UpperArm", "Forearm", "Hand", "Thigh", "Calf", "Foot")],
    "Daz": ["lShldrBend", "lForearmBend", "lHand", "lThighBend", "lShin", "lFoot"],
    "Quaternius": ["UpperArm.L", "LowerArm.L", "Palm.L", "UpperLeg.L", "LowerLeg.L", "Foot.L"],
    "words": ["Left arm", "Left elbow", "Left wrist", "Left leg", "Left knee", "Left ankle"],
    "small letters": ["leftupperarm", "leftlowerarm", "lefthand", "leftthigh", "leftcalf", "leftfoot"],
    "a noun behind": [f"Left{name}Bone" for name in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")],
}


@pytest.mark.parametrize("names", SPELLINGS.values(), ids=SPELLINGS)
def test_the_six_segments_are_known_in_every_spelling(names):
    found = roles_of([*names, "spine", "Hips"])
    assert [each.role for each in found] == [*ROLES, "", ""]
    assert [each.side for each in found] == [1] * 6 + [0, 0]


@pytest.mark.parametrize(
    "name", ["handIK.l", "IK-foot.l", "upperarm_twist_01_l", "handslot.l", "hand_ctrl.L", "LeftHand_End"]
)
def test_bones_that_move_others_are_no_segments(name):
    assert read_bone_name(name).role == ""


@pytest.mark.parametrize("name", ["Leftover", "Lamp", "Handle.L", "Headphone", "Armor.L", "FootIndex2.L", "shoulder.L"])
def test_other_words_are_no_segments(name):
    assert read_bone_name(name).role == ""


def test_the_right_side_is_the_other():
    assert [read_bone_name(name).side for name in ("hand.R", "RightHand", "hand_r", "rHand")] == [-1] * 4
