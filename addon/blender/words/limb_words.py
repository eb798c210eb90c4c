"""Names of limbs as the user reads them."""

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
