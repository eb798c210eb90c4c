"""Other fillings of our shape key: the form of some limbs only, with keys between pose and form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import CanonicalFormError
from .in_betweens import (
    PROPERTY,
    animated,
    changed_in_betweens,
    has_in_betweens,
    remove_in_betweens,
    ways_between,
    write_in_betweens,
)
from .mesh_reading import found_again, object_mode, read_object, require_unchanged
from .records import keep_record, named_key, record_of, required_key, required_record
from .result_writing import patches_of, refill_key, whole_form_of

if TYPE_CHECKING:
    from ..core.numerics.arrays import FloatArray
    from ..core.run.monitor import Cancelled, Progress


def limbs_of(mesh: bpy.types.Mesh) -> list[bool]:
    """Tell of which patches the shape key takes the pose out.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    list of bool
        One flag a patch; empty where there is no form.
    """
    record = record_of(mesh)
    if record is None or not record["key"] or not record["palette"]:
        return []
    return record.get("limbs") or [True] * len(record["palette"])


def variant_refusal(obj: bpy.types.Object | None) -> str | None:
    """Say why the form of an object cannot be varied.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.

    Returns
    -------
    str or None
        A sentence that says what to do, or None.
    """
    if obj is None or obj.type != "MESH" or not limbs_of(obj.data):
        return "The active object has no canonical form. Compute it first."
    if named_key(obj.data) is None:
        return "The shape key of the form was changed, renamed or removed. Compute the form again first."
    return None


class VariantTask:
    """The form of some limbs only, and shapes on the way there.

    Parameters
    ----------
    obj : bpy.types.Object
        An object that `variant_refusal` accepts.
    limbs : list of bool, optional
        The patches to take the pose out of; as they are when left out.
    in_betweens : int, optional
        Number of keys between pose and form; as many as there are when left out.

    Raises
    ------
    CanonicalFormError
        If nothing can be varied, or the key is animated; the message says what to do.
    """

    def __init__(self, obj: bpy.types.Object, limbs: list[bool] | None = None, in_betweens: int | None = None) -> None:
        mesh = obj.data
        reason = variant_refusal(obj)
        if reason is None and in_betweens and not has_in_betweens(mesh):
            reason = animated(mesh)
        if reason is not None:
            raise CanonicalFormError(reason)
        required_key(mesh)
        self.limbs = limbs_of(mesh) if limbs is None else limbs
        between = required_record(mesh).get("between", {})
        self.in_betweens = len(between) if in_betweens is None else in_betweens
        with object_mode(obj):
            self._reading = read_object(obj)
            patches, form = patches_of(mesh), whole_form_of(mesh)
        if patches is None or form is None:
            raise CanonicalFormError(f"The mesh of {obj.name} was changed since the run. Compute the form again first.")
        self._patches, self._form, self.positions = patches, form, form
        self.shapes: list[FloatArray] = []
        self.warnings: list[str] = []

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute the shapes; touches no data of Blender's.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CancelledError
            If `cancelled` returned True.
        """
        from ..core.limb_shapes import limb_shapes
        from ..core.run.monitor import Monitor

        reading, monitor = self._reading, Monitor(progress, cancelled)
        chosen = np.array([*self.limbs, False])[self._patches]  # -1, of no face: the last
        ways = [*ways_between(self.in_betweens), 1.0]
        *self.shapes, self.positions = limb_shapes(reading.vertices, reading.faces, self._form, chosen, ways, monitor)
        self.warnings = monitor.warnings

    def write(self) -> None:
        """Fill the shape key, and the keys between, on the main thread.

        Raises
        ------
        CanonicalFormError
            If the object is gone or changed; the message says why.
        """
        obj = found_again(self._reading)
        with object_mode(obj):
            require_unchanged(obj, self._reading)
            required_key(obj.data)
            left = changed_in_betweens(obj.data)
            if left:
                raise CanonicalFormError(
                    f"Changed since they were made: {', '.join(left)}. Rename them to keep them, or delete them, first."
                )
            value = shown_value(obj.data)
            remove_in_betweens(obj)
            refill_key(obj, self.positions)
            record = required_record(obj.data)
            record["limbs"] = self.limbs
            keep_record(obj.data, record)
            required_key(obj.data).value = value
            if self.shapes:
                write_in_betweens(obj, self.shapes)


def shown_value(mesh: bpy.types.Mesh) -> float:
    """Tell how far the form is dialled in.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with our key.

    Returns
    -------
    float
        Value of the key, or of the property that drives it.
    """
    if has_in_betweens(mesh):
        return float(mesh.shape_keys[PROPERTY])
    return float(required_key(mesh).value)
