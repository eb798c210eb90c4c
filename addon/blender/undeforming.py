"""Where vertices have to be before modifiers and other keys, so that these show them at given places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import CanonicalFormError
from .mesh_reading import read_shown

if TYPE_CHECKING:
    from ..core.surface import FloatArray

_STEPS = 6
_CLOSE = 1e-4  # of the size of the mesh: as near as the shown vertices have to come
_PROBE = 1e-3  # of the size of the mesh: how far vertices are moved to see what the modifiers make of it


def show_at(obj: bpy.types.Object, key: bpy.types.ShapeKey, wanted: FloatArray) -> None:
    """Fill a shape key so that the object shows given positions where the key's value is 1.

    Modifiers are asked what they make of three small shifts of all vertices; for an armature, which moves every
    vertex by a matrix of its own, one step from there is exact.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode, whose modifiers keep the number of vertices.
    key : bpy.types.ShapeKey
        A key that nothing else depends on; its value is 1 afterwards.
    wanted : (n, 3) ndarray of float
        Positions to be shown, in the object's own space.

    Raises
    ------
    CanonicalFormError
        If the modifiers do not follow the vertices closely enough.
    """
    size = float(np.ptp(wanted, axis=0).max())
    mixed = (key.value, key.mute, obj.show_only_shape_key)
    key.value, key.mute, obj.show_only_shape_key = 1.0, False, False

    def shown(positions: FloatArray) -> FloatArray:
        key.data.foreach_set("co", positions.astype(np.float32).ravel())
        obj.data.update()
        bpy.context.view_layer.update()
        return read_shown(obj)[0]

    before = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", before)
    positions = before.reshape(-1, 3).astype(np.float64)
    for _ in range(_STEPS):
        here = shown(positions)
        error = wanted - here
        if float(np.abs(error).max()) <= _CLOSE * size:
            key.mute = mixed[1]
            obj.show_only_shape_key = mixed[2]
            return
        probes = [shown(positions + _PROBE * size * axis) - here for axis in np.eye(3)]
        slope = np.stack(probes, axis=1) / (_PROBE * size)  # (n, 3 moves, 3)
        flat = np.abs(np.linalg.det(slope)) < 1e-6
        slope[flat] = np.eye(3)
        positions = positions + np.einsum("ij,ijk->ik", error, np.linalg.inv(slope))
    key.data.foreach_set("co", before)
    key.value, key.mute, obj.show_only_shape_key = mixed
    raise CanonicalFormError(
        f"The modifiers of {obj.name} do not follow its vertices closely enough for a shape key of what is shown. "
        "Choose Result: New Object."
    )
