"""The form of one object: read, computed apart from Blender, written."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import Settings, TooLargeError
from .advice import all_advised
from .form_report import FormReport, StressReport
from .in_betweens import fractions_between, write_in_betweens
from .mesh_reading import Reading, find_object, read_object, require_unchanged
from .new_objects import add_result_object
from .object_states import object_mode
from .object_warnings import object_warnings
from .palette import Colours, colours_of
from .request import Request
from .result_writing import write_results
from .undeforming import positions_before

if TYPE_CHECKING:
    from ..core import CanonicalForm, FeaturePatches
    from ..core.numerics.arrays import FloatArray
    from ..core.run.monitor import Cancelled, Progress


@dataclass(frozen=True, eq=False)
class FormResult:
    """What was computed for one object.

    Attributes
    ----------
    found : CanonicalForm or FeaturePatches
        The form, or the patches where the request stops there.
    report : FormReport
        The report; writing the result adds warnings about the object.
    colours : Colours
        Colours of the fields and patches.
    shapes : list of (n, 3) ndarray of float
        Shapes between pose and form, for the keys of an earlier run that are computed again.
    """

    found: CanonicalForm | FeaturePatches
    report: FormReport
    colours: Colours
    shapes: list[FloatArray]


@dataclass(eq=False)
class FormItem:
    """One object of a task.

    Attributes
    ----------
    reading : Reading
        The object's arrays.
    settings : Settings
        Options of the method for this object.
    in_between_count : int
        Number of keys between pose and form, of an earlier run, that are computed again.
    result : FormResult or None
        What was computed; None before the computation and where it failed.
    written_to : str or None
        Name of the object that shows the result; None where nothing was written.
    error : str or None
        Why there is no result, or why it could not be written.
    """

    reading: Reading
    settings: Settings
    in_between_count: int = 0
    result: FormResult | None = None
    written_to: str | None = None
    error: str | None = None

    @classmethod
    def read(cls, obj: bpy.types.Object, request: Request) -> FormItem:
        """Read an object.

        Parameters
        ----------
        obj : bpy.types.Object
            The object, in Object Mode.
        request : Request
            What is to be computed.

        Returns
        -------
        FormItem
            The item, ready for the computation.

        Raises
        ------
        CanonicalFormError
            If the request does not suit the object; the message names the remedy.
        """
        settings, in_betweens = request.settings_for(obj), request.in_between_count(obj)
        return cls(read_object(obj, request.deformed), settings, in_betweens)

    def compute(self, request: Request, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute the result; touches no data of Blender's.

        Parameters
        ----------
        request : Request
            What is to be computed.
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CanonicalFormError
            If the mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        from ..core import canonical_form, feature_patches

        reading = self.reading
        work = canonical_form if request.step == "FORM" else feature_patches
        try:
            found = work(reading.vertices, reading.faces, self.settings, progress=progress, cancelled=cancelled)
            shapes = self._shapes_between(found, cancelled)
            colours = colours_of(found.adf, found.patches, reading.faces)
            self.result = FormResult(found, _report(reading, found, request), colours, shapes)
        except MemoryError as error:
            raise TooLargeError(
                f"Not enough memory for {reading.name}. Close other files, or decimate the mesh."
            ) from error

    def write(self, request: Request) -> None:
        """Write the result, on the main thread; the report gets the warnings about the object.

        Parameters
        ----------
        request : Request
            Where the result goes.

        Raises
        ------
        CanonicalFormError
            If the result cannot be written; the message says why.
        """
        if self.result is None:
            return
        reading, result = self.reading, self.result
        obj = find_object(reading)
        with object_mode(obj):
            require_unchanged(obj, reading)
            warnings = result.report.warnings
            warnings += object_warnings(obj, reading.deformed)
            target, found = obj, result.found
            resized = reading.deformed and len(reading.vertices) != len(obj.data.vertices)
            if resized and not request.new_object:
                warnings.append(
                    "Modifiers change the number of vertices, so that no shape key can hold the form: it is on a new "
                    "object."
                )
            if resized or request.new_object:
                target = add_result_object(obj, reading)
            elif reading.deformed and request.step == "FORM":
                found = replace(found, vertices=positions_before(obj, found.vertices))  # type: ignore[arg-type, union-attr]
            patches = request.step != "FEATURES"
            write_results(target, found, result.colours, result.report, value=request.value, patches=patches)
            self.written_to = target.name
            if result.shapes:
                write_in_betweens(obj, result.shapes)

    def _shapes_between(self, found: CanonicalForm | FeaturePatches, cancelled: Cancelled | None) -> list[FloatArray]:
        """Compute the shapes between pose and form; their warnings join those of the form."""
        if not self.in_between_count:
            return []
        from ..core.limbs import limb_shapes
        from ..core.run.monitor import Monitor

        reading, monitor = self.reading, Monitor(None, cancelled)
        everything = np.ones(len(reading.vertices), dtype=bool)
        fractions = fractions_between(self.in_between_count)
        form = found.vertices  # type: ignore[union-attr]
        shapes = limb_shapes(
            reading.vertices,
            reading.faces,
            form,
            everything,
            ways=fractions,
            together=self.settings.together,
            monitor=monitor,
        )
        found.warnings.extend(monitor.warnings)
        return shapes


def _report(reading: Reading, found: CanonicalForm | FeaturePatches, request: Request) -> FormReport:
    from ..core import CanonicalForm
    from ..core.measures.form_measures import summary

    report = FormReport(
        vertices=len(reading.vertices),
        faces=len(reading.faces),
        feature_points=found.feature_points.tolist(),
        patch_sizes=np.bincount(found.patches[found.patches >= 0], minlength=len(found.feature_points)).tolist(),
        timings=found.timings,
        warnings=all_advised(found.warnings),
    )
    if isinstance(found, CanonicalForm):
        measures = summary(reading.vertices, found.vertices, found.faces, request.hausdorff)
        stress = found.stress
        report.stress = StressReport(float(stress[0]), float(stress[-1]), len(stress) - 1)
        report.method, report.pieces = request.settings.method, request.settings.pieces
        report.pair_count, report.pair_reduction = found.pair_count, found.pair_reduction
        report.frame = reading.frame
        report.measures = {name: None if np.isnan(value) else value for name, value in measures.items()}
    return report
