"""The driver that links the form of one object to the slider of another."""

from __future__ import annotations

import bpy

FOLLOWING = "canonical_form_slider"  # name of the driver's variable


def is_following(curve: bpy.types.FCurve) -> bool:
    """Return whether a driver links a form to the slider of another object.

    Parameters
    ----------
    curve : bpy.types.FCurve
        The driver.

    Returns
    -------
    bool
        True if this extension added the driver for this purpose.
    """
    return curve.driver is not None and [each.name for each in curve.driver.variables] == [FOLLOWING]


def release(keys: bpy.types.Key | None) -> None:
    """Remove the driver that links the form to another object, and animation data that nothing else uses.

    Parameters
    ----------
    keys : bpy.types.Key or None
        The shape keys; None if there are none.
    """
    if keys is None or keys.animation_data is None:
        return
    data = keys.animation_data
    own = [curve for curve in data.drivers if is_following(curve)]
    for curve in own:
        data.drivers.remove(curve)
    if own and is_unused(data):
        keys.animation_data_clear()


def is_unused(data: bpy.types.AnimData) -> bool:
    """Return whether animation data is empty.

    Parameters
    ----------
    data : bpy.types.AnimData
        The animation data.

    Returns
    -------
    bool
        True without drivers, action and NLA tracks.
    """
    return not (data.drivers or data.action or data.nla_tracks)
