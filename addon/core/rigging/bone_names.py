"""What bones are, by their names: those of Rigify, Mixamo, Unreal, VRM, Quaternius, Biped and the like."""

from __future__ import annotations

import re
from typing import NamedTuple

ROLES = ("upper arm", "forearm", "hand", "thigh", "shin", "foot")
_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")  # also of camel case
_LEFT, _RIGHT = {"l", "left"}, {"r", "right"}
_CONTROLS = {
    *("ik", "fk", "pole", "target", "ctrl", "control", "mch", "slot", "socket", "attach", "handle", "roll"),
    *("twist", "corrective", "helper", "muscle", "end", "leaf", "tip", "tweak", "vis", "rig"),
}  # bones that move others, mark places or share a segment: none of them begins a segment
_PREFIXES = {
    *("bone", "joint", "jnt", "bind", "skin", "sk", "def", "org", "mixamorig", "mixamo", "bip", "biped", "valve"),
    *("j", "cc", "base", "b", "c", "rig", "armature", "character"),
}
_SPELLINGS = {
    "upper arm": r"(upper|up)arm|arm(upper|up)|shldr(bend)?|humerus|bicep",
    "forearm": r"forearm(bend)?|(lower|low)arm|arm(lower|low)|elbow|ulna",
    "hand": r"hand|wrist|palm[a-z]?|fist",
    "thigh": r"thigh(bend)?|(upper|up)leg|leg(upper|up)|femur",
    "shin": r"shin|calf|(lower|low)leg|leg(lower|low)|knee|tibia",
    "foot": r"foot(back)?|ankle",
}
_ALONE = {"arm": ("upper arm", "forearm"), "leg": ("thigh", "shin")}  # which of the two the other names tell


class BoneName(NamedTuple):
    """What the name of a bone says.

    Attributes
    ----------
    side : int
        1 for the left side, -1 for the right one, 0 for none.
    role : str
        One of `ROLES`, or "arm" or "leg", which may be either segment; empty for any other bone.
    """

    side: int
    role: str


def read_bone_name(name: str) -> BoneName:
    """Read the side and the role of a bone off its name.

    Examples
    --------
    >>> [tuple(read_bone_name(name)) for name in ("mixamorig:LeftUpLeg", "upperarm_r", "J_Bip_L_Hand", "handIK.l")]
    [(1, 'thigh'), (-1, 'upper arm'), (1, 'hand'), (1, '')]
    """
    words = [word.lower() for word in _WORDS.findall(name)]
    side, kept = 0, []
    for word in words:
        if word in _LEFT | _RIGHT:
            side = side or (1 if word in _LEFT else -1)
            continue
        for known, value in (("left", 1), ("right", -1)):
            if word.startswith(known) and not side:
                word, side = word[len(known) :], value
        kept.append(word)
    if set(kept) & _CONTROLS:
        return BoneName(side, "")
    spelled = "".join(word for word in kept if word not in _PREFIXES and not word.isdigit())
    for role, pattern in _SPELLINGS.items():
        if re.fullmatch(pattern, spelled):
            return BoneName(side, role)
    return BoneName(side, spelled if spelled in _ALONE else "")


def roles_of(names: list[str]) -> list[BoneName]:
    """Read the names of all bones of a rig together: a leg without a thigh is one, with a thigh it is the shin.

    Examples
    --------
    >>> [found.role for found in roles_of(["LeftUpLeg", "LeftLeg", "Left arm", "Left elbow"])]
    ['thigh', 'shin', 'upper arm', 'forearm']
    """
    found = [read_bone_name(name) for name in names]
    known = {each.role for each in found}
    for word, (upper, lower) in _ALONE.items():
        meant = lower if upper in known else upper
        found = [each._replace(role=meant) if each.role == word else each for each in found]
    return found
