"""The form of another object as a reference: other forms are aligned to it, with the same numbering of limbs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError, Settings
from ..mesh_items.key_points import key_points
from ..objects.combining import combined
from ..objects.mesh_reading import read_object, refusal
from ..objects.object_states import object_mode
from ..objects.placement import world_rotation
from ..objects.rest_reading import with_rests
from ..records.form_key import require_form_key
from ..records.hidden_attributes import whole_form_of
from ..records.record import read_record, require_record
from ..results.companions import companions_of
from ..words.wording import told

if TYPE_CHECKING:
    from ...core import CanonicalForm
    from ...core.numerics.arrays import FloatArray
    from ...core.run.monitor import Cancelled


class Reference:
    """A form computed earlier. The constructor reads the object, `computed` may run in any thread.

    Parameters
    ----------
    name : str
        Name of the object.

    Raises
    ------
    CanonicalFormError
        If there is no such object, or it has no form.
    """

    def __init__(self, name: str) -> None:
        obj = bpy.data.objects.get(name)
        if obj is None:
            raise CanonicalFormError(
                told("There is no object {name} to refer to. Choose another reference, or none.", name=name)
            )
        reason = refusal(obj)
        if reason is not None:
            raise CanonicalFormError(told("{name} cannot be a reference. {reason}", name=name, reason=reason))
        record = read_record(obj.data)
        if record is None or not record.report.has_form:
            raise CanonicalFormError(
                told("{name} has no form to refer to. Compute its form first, or choose another one.", name=name)
            )
        if record.report.frame is not None and obj.modifiers:
            raise CanonicalFormError(
                told(
                    "The form of {name} is that of the mesh as shown, under modifiers. Compute it "
                    "with Result set to New Object, and choose that one as the reference.",
                    name=name,
                )
            )
        objects = companions_of(obj)
        with object_mode(obj):
            readings = with_rests(objects, [read_object(each, False) for each in objects])
            forms = [_form_of(each) for each in objects]
        whole = combined(readings)
        turn = world_rotation(readings[0].placement) if len(readings) == 1 else np.eye(3)
        self._vertices, self._faces, self._rest = whole.vertices @ turn.T, whole.faces, whole.rest
        self._form = whole.put_together(forms) @ turn.T
        points = record.report.feature_points
        own = len(readings) == 1 and not readings[0].mirrors and min(points, default=-1) >= 0  # -1: on another object
        self._settings = Settings(pieces=record.report.pieces)
        if own:
            names = record.report.feature_names or None
            self._settings = replace(self._settings, feature_points=points, feature_names=names)
        self._computed: CanonicalForm | None = None

    def computed(self, cancelled: Cancelled | None = None) -> CanonicalForm:
        """Compute the features that identify the limbs of the reference.

        Parameters
        ----------
        cancelled : callable, optional
            As in `canonical_form`.

        Returns
        -------
        CanonicalForm
            The form, oriented as in the scene.

        Raises
        ------
        CanonicalFormError
            If the mesh cannot be used, or the run was cancelled.
        """
        if self._computed is None:
            from ...core import CanonicalForm, feature_patches

            found = feature_patches(self._vertices, self._faces, self._settings, rest=self._rest, cancelled=cancelled)
            self._computed = CanonicalForm(
                self._form,
                self._faces,
                found.feature_points,
                found.patches,
                found.adf,
                np.zeros(1),
                0,
                0.0,
                found.timings,
                found.warnings,
                bodies=found.bodies,
                posed=self._vertices if self._rest is None else self._rest,
                eigenvalues=found.eigenvalues,
                feature_names=found.feature_names,
            )
        return self._computed


def _form_of(obj: bpy.types.Object) -> FloatArray:
    """Read the form of an object, in local space."""
    key, whole = require_form_key(obj.data), whole_form_of(obj.data)
    if whole is not None and not all(require_record(obj.data).straightened):
        return whole
    return key_points(key).astype(np.float64)
