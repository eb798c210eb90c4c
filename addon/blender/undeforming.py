"""Where vertices have to be before modifiers and other keys, so that these show them at given places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import CanonicalFormError
from .mesh_reading import read_mesh, read_shown, without_result
from .records import restore_twins, twins_of

if TYPE_CHECKING:
    from ..core.numerics.arrays import FloatArray

_STEPS = 6
_CLOSE = 1e-4  # of the size of the mesh: as near as the shown vertices have to come
_PROBE = 1e-3  # of the size of the mesh: how far vertices are moved to see what the modifiers make of it


def positions_before(obj: bpy.types.Object, wanted: FloatArray) -> FloatArray:
    """Find where vertices have to be in a shape key so that the object shows them at given places.

    Modifiers are asked what they make of three small shifts of all vertices; for an armature, which moves every
    vertex by a matrix of its own, one step from there is exact. A key of its own is added for that and removed again,
    whatever happens.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode, whose modifiers keep the number of vertices.
    wanted : (n, 3) ndarray of float
        Positions to be shown, in the object's own space.

    Returns
    -------
    (n, 3) ndarray of float
        Positions in a shape key relative to the Basis, at value 1, the keys of an earlier run left out.

    Raises
    ------
    CanonicalFormError
        If the modifiers do not follow the vertices closely enough.
    """
    mesh = obj.data
    fresh, active, pinned = mesh.shape_keys is None, obj.active_shape_key_index, obj.show_only_shape_key
    twins = twins_of(obj)
    if fresh:
        obj.shape_key_add(name="Basis", from_mix=False)
    key = obj.shape_key_add(name="Probe", from_mix=False)
    try:
        key.relative_key = mesh.shape_keys.reference_key
        key.value, obj.show_only_shape_key = 1.0, False
        with without_result(mesh):
            return _solved(obj, key, wanted)
    finally:
        obj.shape_key_remove(key)
        if fresh:
            obj.shape_key_clear()
        obj.show_only_shape_key = pinned
        obj.active_shape_key_index = active
        restore_twins(twins)


def _solved(obj: bpy.types.Object, key: bpy.types.ShapeKey, wanted: FloatArray) -> FloatArray:
    size = float(np.ptp(wanted, axis=0).max())

    def shown(positions: FloatArray) -> FloatArray:
        key.data.foreach_set("co", positions.astype(np.float32).ravel())
        obj.data.update()
        bpy.context.view_layer.update()
        return read_shown(obj)[0]

    positions = read_mesh(obj.data)[0]
    for _ in range(_STEPS):
        here = shown(positions)
        error = wanted - here
        if float(np.abs(error).max()) <= _CLOSE * size:
            return positions
        probes = [shown(positions + _PROBE * size * axis) - here for axis in np.eye(3)]
        slope = np.stack(probes, axis=1) / (_PROBE * size)  # (n, 3 moves, 3)
        flat = np.abs(np.linalg.det(slope)) < 1e-6
        slope[flat] = np.eye(3)
        positions = positions + np.einsum("ij,ijk->ik", error, np.linalg.inv(slope))
    raise CanonicalFormError(
        f"The modifiers of {obj.name} do not follow its vertices closely enough for a shape key of what is shown. "
        "Choose Result: New Object."
    )
