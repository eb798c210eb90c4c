"""F-curves of actions, layered (Blender 4.4 and later) or not."""

from __future__ import annotations

import bpy


def curves_of(action: bpy.types.Action) -> list[bpy.types.FCurve]:
    """Return the F-curves of all slots of an action.

    Parameters
    ----------
    action : bpy.types.Action
        The action.

    Returns
    -------
    list of bpy.types.FCurve
        The curves.
    """
    return [curve for curves in curve_lists(action, None) for curve in curves]


def curve_lists(action: bpy.types.Action, slot: int | None) -> list[bpy.types.ActionFCurves]:
    """Return the collections of F-curves of an action.

    Parameters
    ----------
    action : bpy.types.Action
        The action.
    slot : int or None
        Handle of the slot whose curves are wanted; None for all.

    Returns
    -------
    list of bpy.types.ActionFCurves
        The collections.
    """
    if not hasattr(action, "layers"):
        return [action.fcurves]
    bags = [bag for layer in action.layers for strip in layer.strips for bag in getattr(strip, "channelbags", ())]
    return [bag.fcurves for bag in bags if slot in (None, bag.slot_handle)]
