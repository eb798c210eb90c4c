"""The main job: objects in, forms computed apart from Blender, results out, each object's mode kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..core import CanonicalFormError, Settings, TooLargeError
from .chosen_features import MOST_FEATURES, members_of
from .in_betweens import animated, has_in_betweens, ways_between, write_in_betweens
from .mesh_reading import Reading, found_again, object_mode, read_object, require_unchanged
from .new_objects import add_result_object
from .object_warnings import object_warnings
from .palette import Colours, colours_of
from .records import required_record
from .result_writing import clear_results, write_results
from .undeforming import positions_before

if TYPE_CHECKING:
    from ..core import CanonicalForm, FeaturePatches
    from ..core.numerics.arrays import FloatArray
    from ..core.run.monitor import Cancelled, Progress


@dataclass(frozen=True)
class Request:
    """What is to be computed and where the result goes.

    Attributes
    ----------
    settings : Settings
        Options of the method.
    value : float
        Value of the shape key.
    step : {'FORM', 'PATCHES', 'FEATURES'}
        How far to go: feature points, patches, or the form.
    feature_group : str
        Vertex group whose vertices are the feature points; empty to detect them, or for those of the settings.
    deformed : bool
        Work on what modifiers, pose and shape keys show at the current frame, not on the mesh itself.
    new_object : bool
        Put the result on a new object.
    hausdorff : bool
        Measure the Hausdorff distance too.
    """

    settings: Settings = field(default_factory=Settings)
    value: float = 1.0
    step: str = "FORM"
    feature_group: str = ""
    deformed: bool = False
    new_object: bool = False
    hausdorff: bool = False


class FormTask:
    """The forms of some objects: read at once, computed anywhere, written at the end.

    Nothing is written before everything is computed, so an error or a cancel leaves the meshes as they were.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects accepted by `refusal`, the active one first; of those that share a mesh the first is taken.
    request : Request
        What to compute.

    Raises
    ------
    CanonicalFormError
        If an object cannot leave its mode, or a feature group is missing.
    """

    def __init__(self, objects: Sequence[bpy.types.Object], request: Request) -> None:
        self.request = request
        self.readings: list[Reading] = []
        self.settings: list[Settings] = []
        self.found: list[CanonicalForm | FeaturePatches | None] = []
        self.reports: list[dict[str, Any]] = []
        self.colours: list[Colours | None] = []
        self.shapes: list[list[FloatArray]] = []
        self._in_betweens: list[int] = []  # of an earlier run, to be made anew
        self.errors: list[str] = []
        apart = request.deformed or request.new_object  # results of objects that share a mesh do not meet
        first = {obj if apart else obj.data: obj for obj in reversed(objects)}
        with object_mode(objects[0]):
            for obj in reversed(list(first.values())):
                try:
                    settings, in_betweens = _with_features(obj, request), _in_betweens_to_keep(obj, request)
                    self.readings.append(read_object(obj, request.deformed))
                except CanonicalFormError as error:
                    if len(first) == 1:
                        raise
                    self.errors.append(str(error))
                    continue
                self.settings.append(settings)
                self._in_betweens.append(in_betweens)

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute everything; touches no data of Blender's.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CanonicalFormError
            If the only mesh cannot be used, or the run was cancelled; the message says what to do.
        """
        from ..core import canonical_form, feature_patches
        from ..core.limb_shapes import limb_shapes
        from ..core.run.monitor import Monitor

        count = len(self.readings)
        work = canonical_form if self.request.step == "FORM" else feature_patches
        for number, (reading, settings) in enumerate(zip(self.readings, self.settings, strict=True)):

            def told(done: float, stage: str, number: int = number, name: str = reading.name) -> None:
                if progress is not None:
                    progress((number + done) / count, stage if count == 1 else f"{name}: {stage}")

            self.found.append(None)
            self.reports.append({})
            self.colours.append(None)
            self.shapes.append([])
            try:
                found = _worked(work, reading, settings, told, cancelled)
            except CanonicalFormError as error:
                if count == 1 or (cancelled is not None and cancelled()):
                    raise
                self.errors.append(f"{reading.name}: {error}")
                continue
            self.found[-1] = found
            if self._in_betweens[number]:
                whole = np.ones(len(reading.vertices), dtype=bool)
                ways = ways_between(self._in_betweens[number])
                form = found.vertices  # type: ignore[union-attr]
                between = Monitor(None, cancelled)
                self.shapes[-1] = limb_shapes(reading.vertices, reading.faces, form, whole, ways, between)
                found.warnings.extend(between.warnings)
            self.colours[-1] = colours_of(found.adf, found.patches, reading.faces)
            self.reports[-1] = _report(reading, found, self.request)

    def write(self) -> list[str]:
        """Write the results, on the main thread.

        Returns
        -------
        list of str
            Names of the objects that show results.

        Raises
        ------
        CanonicalFormError
            If nothing could be written; the message says why.
        """
        done: list[str] = []
        for number, (reading, found, colours) in enumerate(zip(self.readings, self.found, self.colours, strict=True)):
            if found is None or colours is None:
                continue
            try:
                done.append(self._write_one(reading, found, colours, self.reports[number]))
                if self.shapes[number]:
                    obj = found_again(reading)
                    with object_mode(obj):
                        write_in_betweens(obj, self.shapes[number])
            except CanonicalFormError as error:
                self.errors.append(str(error))
        if not done:
            raise CanonicalFormError(" ".join(self.errors))
        return done

    def _write_one(
        self, reading: Reading, found: CanonicalForm | FeaturePatches, colours: Colours, report: dict[str, Any]
    ) -> str:
        request = self.request
        obj = found_again(reading)
        with object_mode(obj):
            require_unchanged(obj, reading)
            report["warnings"] += object_warnings(obj, reading.deformed)
            patches = request.step != "FEATURES"
            changed = reading.deformed and len(reading.vertices) != len(obj.data.vertices)
            if changed and not request.new_object:
                report["warnings"].append(
                    "Modifiers change the number of vertices, so that no shape key can hold the form: it is on a new "
                    "object."
                )
            if request.new_object or changed:
                target = add_result_object(obj, reading)
                write_results(target, found, colours, request.value, report, patches)
                return target.name
            if reading.deformed and request.step == "FORM":
                found = replace(found, vertices=positions_before(obj, found.vertices))  # type: ignore[arg-type, union-attr]
            write_results(obj, found, colours, request.value, report, patches)
        return obj.name


def compute_on(
    obj: bpy.types.Object,
    request: Request,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> tuple[CanonicalForm | FeaturePatches, dict[str, Any]]:
    """Compute the canonical form of one object and write it there, at once.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`; in any mode.
    request : Request
        What to compute.
    progress, cancelled : callable, optional
        As in `canonical_form`.

    Returns
    -------
    found : CanonicalForm or FeaturePatches
        The result.
    report : dict
        Counts, stress, measures, timings and warnings, ready for JSON (nan as None).

    Raises
    ------
    CanonicalFormError
        If the mesh cannot be used, or the run was cancelled; the message says what to do.
    """
    task = FormTask([obj], request)
    task.compute(progress, cancelled)
    task.write()
    found = task.found[0]
    assert found is not None  # compute raises for a single object
    return found, task.reports[0]


def clear_from(obj: bpy.types.Object) -> list[str]:
    """Remove from an object's mesh what was written there, in any mode.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    list of str
        Names of results that were left in place because they have been changed since.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    with object_mode(obj):
        return clear_results(obj)


def _worked(work: Any, reading: Reading, settings: Settings, told: Progress, cancelled: Cancelled | None) -> Any:
    """Compute, and say so where the machine has not enough memory after all."""
    try:
        return work(reading.vertices, reading.faces, settings, told, cancelled)
    except MemoryError as error:
        raise TooLargeError(
            f"The memory of this machine is not enough for {reading.name}. Close other files, or decimate the mesh."
        ) from error


def _in_betweens_to_keep(obj: bpy.types.Object, request: Request) -> int:
    """Count the keys between pose and form that are to be made anew with the form."""
    if request.step != "FORM" and not request.new_object:
        reason = animated(obj.data)
        if reason is not None or has_in_betweens(obj.data):
            raise CanonicalFormError(
                f"This step would take the form of {obj.name} away, and it is animated or has in-betweens. Clear first."
            )
    if request.new_object or request.deformed or request.step != "FORM" or not has_in_betweens(obj.data):
        return 0
    return len(required_record(obj.data)["between"])


def _with_features(obj: bpy.types.Object, request: Request) -> Settings:
    """Take the feature points from the vertex group, if one is named."""
    if not request.feature_group:
        return request.settings
    group = obj.vertex_groups.get(request.feature_group)
    if group is None:
        raise CanonicalFormError(
            f"{obj.name} has no vertex group {request.feature_group}. Choose one, or set Feature Points to Detected."
        )
    if request.deformed:
        raise CanonicalFormError("Feature points from a group need the mesh itself. Set Mesh to Base Mesh.")
    members = members_of(obj, group.name)
    if not members:
        raise CanonicalFormError(f"The vertex group {group.name} of {obj.name} is empty. Add feature points to it.")
    if len(members) > MOST_FEATURES:
        raise CanonicalFormError(
            f"The vertex group {group.name} has {len(members):,} vertices. Choose one of {MOST_FEATURES} at most."
        )
    return replace(request.settings, feature_points=members)


def _report(reading: Reading, found: CanonicalForm | FeaturePatches, request: Request) -> dict[str, Any]:
    from ..core import CanonicalForm
    from ..core.measures.form_measures import summary

    report: dict[str, Any] = {
        "vertices": len(reading.vertices),
        "faces": len(reading.faces),
        "feature_points": found.feature_points.tolist(),
        "patch_sizes": np.bincount(found.patches[found.patches >= 0], minlength=len(found.feature_points)).tolist(),
    }
    if isinstance(found, CanonicalForm):
        measures = summary(reading.vertices, found.vertices, found.faces, request.hausdorff)
        stress = found.stress
        report |= {
            "method": request.settings.method,
            "stress": {"first": float(stress[0]), "last": float(stress[-1]), "steps": len(stress) - 1},
            "pair_count": found.pair_count,
            "pair_reduction": found.pair_reduction,
            "measures": {name: None if np.isnan(number) else number for name, number in measures.items()},
        }
    return report | {"timings": found.timings, "warnings": list(found.warnings)}
