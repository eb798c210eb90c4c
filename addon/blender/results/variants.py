"""Variants of the form's shape key: the form of some limbs only, with keys between pose and form."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.slider import release
from ..objects.combining import combined
from ..objects.mesh_reading import Reading, find_object, names_of, read_object, require_unchanged
from ..objects.object_states import muted_results, object_mode, unrefined
from ..objects.rest_reading import with_rests
from ..objects.undeforming import positions_before, shown_at
from ..records.form_key import require_form_key
from ..records.hidden_attributes import patches_of, whole_form_of
from ..records.record import require_record
from ..words.advice import all_advised
from ..words.wording import listed, told
from .companions import companions_of, lead
from .in_betweens import (
    PROPERTY,
    animated,
    changed_in_betweens,
    fractions_between,
    has_in_betweens,
    remove_in_betweens,
    write_in_betweens,
)
from .limb_states import variant_refusal
from .result_writing import refill_key

if TYPE_CHECKING:
    from ...core import KeptStages
    from ...core.numerics.arrays import FloatArray
    from ...core.run.monitor import Cancelled, Progress


class VariantTask:
    """The form of some limbs only, and the in-between shapes, of an object and all objects that follow its slider.

    Parameters
    ----------
    obj : bpy.types.Object
        An object that `variant_refusal` accepts.
    limbs : list of bool, optional
        For each patch, whether to remove its pose; unchanged if omitted.
    in_betweens : int, optional
        Number of keys between pose and form; unchanged if omitted.
    keep : KeptStages, optional
        Stages kept from earlier runs on the same objects: their coarse mesh is reused.

    Attributes
    ----------
    limbs : list of bool
        For each patch, whether to remove its pose.
    in_betweens : int
        Number of keys between pose and form.
    warnings : list of str
        Sentences for the user.

    Raises
    ------
    CanonicalFormError
        If there is no form to change, or its key is animated; the message names the remedy.
    """

    def __init__(
        self,
        obj: bpy.types.Object,
        limbs: list[bool] | None = None,
        in_betweens: int | None = None,
        *,
        keep: KeptStages | None = None,
    ) -> None:
        objects = companions_of(obj)
        for each in objects:
            reason = variant_refusal(each)
            if reason is None and in_betweens and not has_in_betweens(each.data):
                reason = animated(each.data)
            if reason is not None:
                raise CanonicalFormError(reason)
            require_form_key(each.data)
        record = require_record(obj.data)
        self.limbs = record.straightened if limbs is None else limbs
        self.in_betweens = len(record.in_between_keys) if in_betweens is None else in_betweens
        self._together = record.report.pieces == "together"
        self._readings: list[Reading] = []
        patches, forms = [], []
        with object_mode(obj), muted_results(each.data for each in objects), unrefined(objects):
            for each in objects:
                own, form = patches_of(each.data), whole_form_of(each.data)
                if own is None or form is None:
                    raise CanonicalFormError(
                        told(
                            "The mesh of {name} was changed since the run. Compute the form again first.",
                            name=each.name,
                        )
                    )
                reading, form = _as_at_the_run(each, form)
                self._readings.append(reading)
                patches.append(own)
                forms.append(form)
            self._readings = with_rests(objects, self._readings)
        self._whole = combined(self._readings)
        self._patches, self._form = self._whole.spread(patches), self._whole.put_together(forms)
        self._keep = None if keep is None else keep.part(names_of(self._readings))
        self._shapes = [forms]  # for each shape, the positions of each object; the form is the last shape
        self.warnings: list[str] = []

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute the shapes; does not access Blender's data.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CancelledError
            If `cancelled` returned True.
        """
        from ...core.limbs import limb_shapes
        from ...core.run.monitor import Monitor

        monitor = Monitor(progress, cancelled, keep=self._keep)
        chosen = np.array([*self.limbs, False])[self._patches]  # index -1, no patch, is the last element
        shapes = limb_shapes(
            self._whole.vertices,
            self._whole.faces,
            self._form,
            chosen,
            ways=[*fractions_between(self.in_betweens), 1.0],
            together=self._together,
            rest=self._whole.rest,
            monitor=monitor,
        )
        self._shapes = [self._whole.brought_back(shape) for shape in shapes]
        self.warnings = all_advised(monitor.warnings)

    def write(self) -> None:
        """Write the positions to the shape keys and add the in-between keys, in the main thread.

        Raises
        ------
        CanonicalFormError
            If an object was removed or changed; the message says why.
        """
        objects = [find_object(reading) for reading in self._readings]
        with ExitStack() as modes:
            for obj in objects:
                modes.enter_context(object_mode(obj))
            modes.enter_context(unrefined(objects))
            with muted_results(obj.data for obj in objects):
                for obj, reading in zip(objects, self._readings, strict=True):
                    require_unchanged(obj, reading)
            for obj in objects:
                require_form_key(obj.data)
                left = changed_in_betweens(obj.data)
                if left:
                    raise CanonicalFormError(
                        told(
                            "Changed since they were made: {left}. Rename them to keep them, or delete them, first.",
                            left=listed(left),
                        )
                    )
            shapes = [list(each) for each in zip(*self._shapes, strict=True)]
            if self._readings[0].deformed:
                shapes = [positions_before(obj, each) for obj, each in zip(objects, shapes, strict=True)]
            for obj, (*between, positions) in zip(objects, shapes, strict=True):
                self._write_one(obj, positions, between)
            lead(objects)

    def _write_one(self, obj: bpy.types.Object, positions: FloatArray, shapes: list[FloatArray]) -> None:
        """Write the positions of one object and its in-between keys."""
        value = shown_value(obj.data)
        release(obj.data.shape_keys)
        remove_in_betweens(obj)
        refill_key(obj, positions, self.limbs)
        require_form_key(obj.data).value = value
        if shapes:
            write_in_betweens(obj, shapes)


def _as_at_the_run(obj: bpy.types.Object, form: FloatArray) -> tuple[Reading, FloatArray]:
    """Read pose and form of an object as in the run: of the base or evaluated mesh, with the transform it had then."""
    record = require_record(obj.data)
    reading = read_object(obj, record.report.frame is not None)
    if len(reading.vertices) != len(obj.data.vertices):
        raise CanonicalFormError(
            told(
                "Modifiers now change the number of vertices of {name}. Switch them off in the "
                "views, or compute the form again.",
                name=obj.name,
            )
        )
    if reading.deformed:
        form = shown_at(obj, form)
    if record.part is not None:  # the object may have moved since the run
        then = np.array(record.part.placement)
        elsewhere = not np.allclose(then, reading.placement, atol=1e-5 * max(1.0, float(np.abs(then).max())))
        if elsewhere and reading.deformed and reading.frame != record.report.frame:
            raise CanonicalFormError(
                told(
                    "The form of {name} is that of frame {frame}. Go there, or compute it again first.",
                    name=obj.name,
                    frame=record.report.frame,
                )
            )
        reading = reading._replace(placement=then)
    return reading, form


def shown_value(mesh: bpy.types.Mesh) -> float:
    """Return the value at which the form is shown.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh; the form's key is unchanged.

    Returns
    -------
    float
        Value of the key, or of the property that drives it.
    """
    if has_in_betweens(mesh):
        return float(mesh.shape_keys[PROPERTY])
    return float(require_form_key(mesh).value)
