"""How other programs call the bones of the mannequin, so that their animations find them."""

from __future__ import annotations

from collections.abc import Sequence

from .skeleton import mirror_name

_MIXAMO = {
    "spine": "Hips",
    "spine.001": "Spine",
    "spine.002": "Spine1",
    "spine.003": "Spine2",
    "spine.004": "Neck",
    "spine.006": "Head",
    "shoulder": "{Side}Shoulder",
    "upper_arm": "{Side}Arm",
    "forearm": "{Side}ForeArm",
    "hand": "{Side}Hand",
    "thigh": "{Side}UpLeg",
    "shin": "{Side}Leg",
    "foot": "{Side}Foot",
    "toe": "{Side}ToeBase",
}
_UNREAL = {
    "spine": "pelvis",
    "spine.001": "spine_01",
    "spine.002": "spine_02",
    "spine.003": "spine_03",
    "spine.004": "neck_01",
    "spine.006": "head",
    "shoulder": "clavicle_{s}",
    "upper_arm": "upperarm_{s}",
    "forearm": "lowerarm_{s}",
    "hand": "hand_{s}",
    "thigh": "thigh_{s}",
    "shin": "calf_{s}",
    "foot": "foot_{s}",
    "toe": "ball_{s}",
}
_VRM = {
    "spine": "hips",
    "spine.001": "spine",
    "spine.002": "chest",
    "spine.003": "upperChest",
    "spine.004": "neck",
    "spine.006": "head",
    "shoulder": "{side}Shoulder",
    "upper_arm": "{side}UpperArm",
    "forearm": "{side}LowerArm",
    "hand": "{side}Hand",
    "thigh": "{side}UpperLeg",
    "shin": "{side}LowerLeg",
    "foot": "{side}Foot",
    "toe": "{side}Toes",
}
_TABLES = {"MIXAMO": _MIXAMO, "UNREAL": _UNREAL, "VRM": _VRM}
_PREFIXES = {"MIXAMO": "mixamorig:"}
NAMINGS = ("RIGIFY", *_TABLES)


def named_as(names: Sequence[str], naming: str) -> list[str]:
    """Call the mannequin's bones as another program does. `naming`: one of `NAMINGS`.

    Examples
    --------
    >>> named_as(["spine", "forearm.L"], "MIXAMO"), named_as(["shin.R"], "UNREAL"), named_as(["toe.L"], "VRM")
    (['mixamorig:Hips', 'mixamorig:LeftForeArm'], ['calf_r'], ['leftToes'])
    """
    if naming not in _TABLES:
        return list(names)
    found = []
    for name in names:
        side = {".L": "left", ".R": "right"}.get(name[-2:] if mirror_name(name) != name else "", "")
        own = _TABLES[naming][name.removesuffix(name[-2:]) if side else name]
        found.append(_PREFIXES.get(naming, "") + own.format(Side=side.capitalize(), side=side, s=side[:1]))
    return found
