"""Names of limbs, and of their ends, as the user reads them."""

from __future__ import annotations

from .wording import told

LIMBS = {  # as the core names them
    "head": "Head",
    "left_hand": "Left Hand",
    "right_hand": "Right Hand",
    "left_foot": "Left Foot",
    "right_foot": "Right Foot",
    "tail": "Tail",
}
PARTS = {  # of the body, by the end of each
    "head": "Head",
    "left_hand": "Left Arm",
    "right_hand": "Right Arm",
    "left_foot": "Left Leg",
    "right_foot": "Right Leg",
    "tail": "Tail",
}
OTHER = "Other"


def told_limb(name: str) -> str:
    """Return the name of a limb in the language of Blender's interface.

    Parameters
    ----------
    name : str
        As the core names it; "" for a limb without a name.

    Returns
    -------
    str
        The name.

    Examples
    --------
    >>> told_limb("left_hand"), told_limb("")
    ('Left Hand', 'Other')
    """
    return told(LIMBS.get(name, OTHER))


def told_part(name: str, number: int) -> str:
    """Return the name of a part of the body in the language of Blender's interface.

    Parameters
    ----------
    name : str
        As the core names its end; "" for a part without a name.
    number : int
        Its number, from 1, by which it is called without one.

    Returns
    -------
    str
        The name.

    Examples
    --------
    >>> told_part("left_hand", 2), told_part("", 3)
    ('Left Arm', 'Limb 3')
    """
    return told(PARTS[name]) if name in PARTS else told("Limb {number}", number=number)
