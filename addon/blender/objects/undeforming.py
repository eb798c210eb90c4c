"""Inverts modifiers and other shape keys: finds the positions that they move to given positions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.active_items import active_keys_elsewhere, restore_active_keys
from ..words.wording import told
from .mesh_reading import read_evaluated, read_mesh
from .object_states import muted_results

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray

    Evaluate = Callable[[FloatArray], FloatArray]

_STEPS = 6
_TOLERANCE = 1e-4  # of the size of the mesh: largest error of an evaluated vertex
_PROBE = 1e-3  # of the size of the mesh: step of the finite differences


def positions_before(obj: bpy.types.Object, shapes: Sequence[FloatArray]) -> list[FloatArray]:
    """Return the vertex positions in a shape key for which the evaluated mesh has given positions.

    Newton's method, with the Jacobian of every vertex from finite differences for three small shifts of all vertices;
    for an armature, which moves every vertex by its own matrix, one step is exact. The temporary shape key is removed
    again, even after an error.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode; its modifiers keep the number of vertices.
    shapes : sequence of (n, 3) ndarray of float
        Target positions in the evaluated mesh, in the object's local space.

    Returns
    -------
    list of (n, 3) ndarray of float
        For each shape, the positions in a shape key relative to the Basis, at value 1, with the keys of an earlier run
        muted.

    Raises
    ------
    CanonicalFormError
        If the modifiers cannot be inverted accurately enough.
    """
    with _probe(obj) as evaluated:
        base = read_mesh(obj.data)[0]
        here = evaluated(base)
        inverse = None  # of the Jacobian at the base positions, computed for the first shape that needs it
        found = []
        for wanted in shapes:
            size = float(np.ptp(wanted, axis=0).max())
            if float(np.abs(wanted - here).max()) <= _TOLERANCE * size:
                found.append(base)
                continue
            if inverse is None:
                inverse = _inverse_jacobian(evaluated, base, here, size)
            found.append(_solved(obj, evaluated, base + np.einsum("ij,ijk->ik", wanted - here, inverse), wanted))
        return found


def shown_at(obj: bpy.types.Object, positions: FloatArray) -> FloatArray:
    """Return the positions that the evaluated mesh has for the positions in a shape key.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode; its modifiers keep the number of vertices.
    positions : (n, 3) ndarray of float
        Positions in a shape key relative to the Basis, at value 1.

    Returns
    -------
    (n, 3) ndarray of float
        Positions in the evaluated mesh, with the keys of an earlier run muted.
    """
    with _probe(obj) as evaluated:
        return evaluated(positions)


@contextmanager
def _probe(obj: bpy.types.Object) -> Iterator[Evaluate]:
    """Add a temporary shape key, and return a function that evaluates the mesh with given positions in it."""
    mesh = obj.data
    fresh, active, pinned = mesh.shape_keys is None, obj.active_shape_key_index, obj.show_only_shape_key
    elsewhere = active_keys_elsewhere(obj)
    if fresh:
        obj.shape_key_add(name="Basis", from_mix=False)
    key = obj.shape_key_add(name="Probe", from_mix=False)

    def evaluated(positions: FloatArray) -> FloatArray:
        key.points.foreach_set("co", positions.astype(np.float32).ravel())
        mesh.update()
        bpy.context.view_layer.update()
        return read_evaluated(obj)[0]

    try:
        key.relative_key = mesh.shape_keys.reference_key
        key.value, obj.show_only_shape_key = 1.0, False
        with muted_results([mesh]):
            yield evaluated
    finally:
        obj.shape_key_remove(key)
        if fresh:
            obj.shape_key_clear()
        obj.show_only_shape_key = pinned
        obj.active_shape_key_index = active
        restore_active_keys(elsewhere)


def _solved(obj: bpy.types.Object, evaluated: Evaluate, positions: FloatArray, wanted: FloatArray) -> FloatArray:
    """Iterate from the first step until the evaluated mesh has the target positions."""
    size = float(np.ptp(wanted, axis=0).max())
    for _ in range(_STEPS - 1):
        here = evaluated(positions)
        error = wanted - here
        if float(np.abs(error).max()) <= _TOLERANCE * size:
            return positions
        positions = positions + np.einsum("ij,ijk->ik", error, _inverse_jacobian(evaluated, positions, here, size))
    raise CanonicalFormError(
        told(
            "The modifiers of {name} do not follow its vertices closely enough for a shape key of "
            "what is shown. Choose Written As: New Object.",
            name=obj.name,
        )
    )


def _inverse_jacobian(evaluated: Evaluate, positions: FloatArray, here: FloatArray, size: float) -> FloatArray:
    """Invert the Jacobian of every vertex; vertices that do not move get the identity."""
    probes = [evaluated(positions + _PROBE * size * axis) - here for axis in np.eye(3)]
    jacobian = np.stack(probes, axis=1) / (_PROBE * size)  # (n, 3 shifts, 3)
    singular = np.abs(np.linalg.det(jacobian)) < 1e-6
    jacobian[singular] = np.eye(3)
    inverse: FloatArray = np.linalg.inv(jacobian)
    return inverse
