"""The form of one object, or of several that are one body: read, computed without Blender, written."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ...core import CanonicalFormError, Settings, TooLargeError
from ..mesh_items.fingerprints import fingerprint
from ..objects.body_points import NO_POINTS, BodyPoints
from ..objects.combining import Combined, combined
from ..objects.marked_contacts import Marks, read_marks
from ..objects.mesh_reading import Reading, find_object, names_of, read_object, require_unchanged
from ..objects.object_states import object_mode, unrefined
from ..objects.object_warnings import object_warnings, turned_key_warnings
from ..objects.placement import world_rotation
from ..objects.undeforming import positions_before
from ..records.record import Part
from ..results.companions import companions_of, lead, own_sliders, set_free, with_companions
from ..results.in_betweens import animated, animated_slider, write_in_betweens
from ..results.new_objects import add_result_object
from ..results.result_clearing import clear_results
from ..results.result_writing import key_name, refill_key, write_results
from ..words.wording import listed, told
from .form_result import FormResult, folded, results_of
from .item_pose import posed_like
from .item_settings import settings_on
from .item_shapes import chosen_limbs, kept_limbs, shapes_of
from .parted_result import on_parted_object, turned
from .request import Request

if TYPE_CHECKING:
    from ...core import CanonicalForm
    from ...core.numerics.arrays import FloatArray
    from ...core.results import AnyResult
    from ...core.run.monitor import Cancelled, Progress


@dataclass(eq=False)
class FormItem:
    """One body of a task: an object, or several.

    Attributes
    ----------
    readings : list of Reading
        The arrays of each object.
    chosen : list of BodyPoints
        Feature points chosen by hand on each object.
    marks : list of Marks
        Contacts marked by hand on each object.
    settings : Settings
        Options of the method.
    in_between_count : int
        Number of keys between pose and form, from an earlier run, to be computed again.
    leads : bool
        Whether the slider of the object is animated or moves the forms of other objects, and must be kept.
    limbs : list of dict
        Which limbs of each object are straightened, as from `chosen_limbs`.
    straightened : list of bool
        For each patch, whether its pose is removed; empty if that of all is.
    results : list of FormResult
        The result for each object; empty before the computation and after an error.
    written_to : list of str
        Names of the objects that show the results; empty if nothing was written.
    error : str or None
        Why there is no result, or why it could not be written.
    bodies : int
        Number of bodies that the selected objects are, if they were to be joined.
    whole_form : CanonicalForm or None
        The form of all objects, oriented as in the scene, as a reference for other forms.
    """

    readings: list[Reading]
    chosen: list[BodyPoints]
    marks: list[Marks]
    settings: Settings
    in_between_count: int = 0
    leads: bool = False
    limbs: list[dict[int | str, bool]] = field(default_factory=list)
    straightened: list[bool] = field(default_factory=list)
    results: list[FormResult] = field(default_factory=list)
    written_to: list[str] = field(default_factory=list)
    error: str | None = None
    bodies: int = 1
    whole_form: CanonicalForm | None = None

    @classmethod
    def read(cls, obj: bpy.types.Object, request: Request) -> FormItem:
        """Read an object.

        Parameters
        ----------
        obj : bpy.types.Object
            The object, in Object Mode.
        request : Request
            What to compute.

        Returns
        -------
        FormItem
            The item, ready for the computation.

        Raises
        ------
        CanonicalFormError
            If the request cannot be applied to the object; the message names the remedy.
        """
        in_betweens = request.in_between_count(obj)
        body = companions_of(obj)
        leads = animated_slider(obj.data) or (len(body) > 1 and body[0] == obj)
        reading = read_object(obj, request.deformed)
        marks = read_marks(obj, len(reading.vertices))
        points, limbs = request.points_for(obj, reading), chosen_limbs(obj, request)
        return cls([reading], [points], [marks], request.settings, in_betweens, leads, [limbs])

    @classmethod
    def joined(cls, items: Sequence[FormItem], request: Request) -> FormItem:
        """Combine several items into one body.

        Parameters
        ----------
        items : sequence of FormItem
            The items, at least one.
        request : Request
            What to compute. Feature points are the members of the vertex group of every object, or vertices of the
            first object.

        Returns
        -------
        FormItem
            One item of all.
        """
        first, items = items[0], sorted(items, key=lambda item: not item.leads)
        of_first = request.settings.feature_points is not None and not request.feature_group
        chosen = [item.chosen[0] if item is first or not of_first else NO_POINTS for item in items]
        readings = [reading for item in items for reading in item.readings]
        marks = [each for item in items for each in item.marks]
        limbs = [each for item in items for each in item.limbs]
        return cls(readings, chosen, marks, first.settings, max(each.in_between_count for each in items), limbs=limbs)

    @property
    def name(self) -> str:
        """Name of the object, or of the first object and the number of others."""
        more = len(self.readings) - 1
        return told("{name} and {more} more", name=self.readings[0].name, more=more) if more else self.readings[0].name

    @property
    def resized(self) -> list[str]:
        """Names of the objects whose modifiers change the number of vertices, so that no shape key can hold a form."""
        there = [(find_object(each), len(each.vertices)) for each in self.readings]  # renamed meanwhile, perhaps
        return [obj.name for obj, count in there if count != len(obj.data.vertices)]

    @property
    def _body(self) -> str:
        """Combined fingerprint of the objects."""
        parts = str([(each.name, each.fingerprint) for each in self.readings])
        return fingerprint(np.frombuffer(parts.encode(), dtype=np.uint8))

    def compute(self, request: Request, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute the results; does not access Blender's data.

        Parameters
        ----------
        request : Request
            What to compute.
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CanonicalFormError
            If the mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        from ...core import feature_patches

        request.require_points(self.name, self.chosen)
        try:
            whole = combined(self.readings)
            settings = settings_on(whole, self.settings, self.chosen, self.marks)
            found: AnyResult
            how: dict[str, Any]
            carried = None
            if request.likeness is not None:
                self._require_no_mirror(
                    told(
                        "{name} has a Mirror modifier, and what is posed has to stay on the mirror. Set Mesh to As "
                        "Shown, or apply the modifier.",
                        name=self.name,
                    )
                )
                keep = None  # as below: not with all vertices
                if request.keep is not None and not settings.whole:
                    keep = request.keep.part(("pose", names_of(self.readings)))
                found, carried = posed_like(self.readings, whole, request.likeness, settings, progress, cancelled, keep)
            elif request.step == "FORM":
                found = self._form(whole, settings, request, progress, cancelled)
            else:
                how = {"rest": whole.rest, "progress": progress, "cancelled": cancelled}
                found = feature_patches(whole.vertices, whole.faces, settings, named=True, **how)
            if any(reading.mirrors for reading in self.readings):
                found = folded(found, whole)
            self.straightened = kept_limbs(self.limbs, whole, found, request.limb)
            keep = None if request.keep is None else request.keep.part(names_of(self.readings))
            how = {"together": settings.together, "keep": keep, "cancelled": cancelled}
            shapes = shapes_of(whole, found, self.in_between_count, self.straightened, **how)
            if request.hausdorff and progress is not None:
                progress(1.0, "Hausdorff distance")  # which takes longer than the form
            self.results = results_of(self.readings, whole, found, shapes, request, carried)
        except MemoryError as error:
            raise TooLargeError(
                told("Not enough memory for {name}. Close other files, or decimate the mesh.", name=self.name)
            ) from error

    def require_unchanged(self, request: Request) -> None:
        """Require that the objects have not changed since they were read.

        Parameters
        ----------
        request : Request
            How they were read.

        Raises
        ------
        CanonicalFormError
            If an object was removed or changed, or cannot be written to; the message says which and why.
        """
        for reading in self.readings:
            obj = find_object(reading)
            with object_mode(obj), unrefined([obj] if request.unrefined else ()):
                require_unchanged(obj, reading)

    def write(self, request: Request, taken: Collection[str]) -> None:
        """Write the results, in the main thread, and add the warnings about the objects to the reports.

        Parameters
        ----------
        request : Request
            Where the results go.
        taken : collection of str
            Names of all objects of the task; other objects of an earlier body no longer follow this one.

        Raises
        ------
        CanonicalFormError
            If a result cannot be written; the message says why.
        """
        objects = [find_object(reading) for reading in self.readings]
        for obj in objects if self.in_between_count and not request.new_object else ():
            reason = animated(obj.data)
            if reason is not None:
                raise CanonicalFormError(reason)
        body = [] if request.new_object else with_companions(objects)
        former = [obj for obj in body if obj.name not in taken]
        with ExitStack() as modes:
            for obj in objects:
                modes.enter_context(object_mode(obj))
            with unrefined(objects if request.unrefined else ()):
                self._write_to(objects, former, request)
        for obj in former:
            set_free(obj)

    def _write_to(self, objects: list[bpy.types.Object], former: list[bpy.types.Object], request: Request) -> None:
        """Write the results; the objects are in Object Mode."""
        warnings = self.results[0].report.warnings  # shared by all
        if self.bodies > 1:
            warnings.insert(
                0,
                told(
                    "The objects are {count} bodies that do not touch. Each has its own feature points and form and "
                    "stays in place.",
                    count=self.bodies,
                ),
            )
        new = request.new_object
        warnings += [
            told(
                "{name} could not take part: its form is of an earlier run and no longer follows the slider.",
                name=obj.name,
            )
            for obj in former
        ]
        if request.step != "FEATURES":
            warnings += object_warnings(objects, self.readings[0].deformed, scaled=len(objects) > 1)
        resized = [] if new else self.resized
        if resized:
            warnings.append(
                told(
                    "Modifiers change the number of vertices of {resized}, so that no shape key can "
                    "hold the form: it is on a new object.",
                    resized=listed(resized),
                )
            )
            new = True
        if request.step == "FORM" and not new:
            warnings += own_sliders(objects)
        found = [(result.found, result.shapes) for result in self.results]
        if self.readings[0].deformed and request.step == "FORM" and not new:
            found = [_before_modifiers(obj, *each) for obj, each in zip(objects, found, strict=True)]
        if request.step == "FORM" and not new:
            warnings += turned_key_warnings(objects, [each.vertices for each, _ in found])  # type: ignore[union-attr]
        called = key_name(self.results[0].report)
        targets: list[bpy.types.Object] = []
        done = False
        try:
            for number, obj in enumerate(objects):
                targets.append(add_result_object(obj, self.readings[number], called) if new else obj)
                if new:
                    self.results[number] = on_parted_object(targets[-1], self.readings[number], self.results[number])
                    found[number] = (self.results[number].found, self.results[number].shapes)
                self._write_one(number, targets[-1], *found[number], request)
            if request.step == "FORM":
                lead(targets)
            done = True
        finally:
            for target in targets if not done else ():
                clear_results(target)
        self.written_to = [target.name for target in targets]

    def _write_one(
        self,
        number: int,
        target: bpy.types.Object,
        found: AnyResult,
        shapes: list[FloatArray],
        request: Request,
    ) -> None:
        """Write the result of one object."""
        result = self.results[number]
        placement = self.readings[number].placement.tolist()
        part = Part(number, placement, self._body) if len(self.readings) > 1 else None
        patches = request.step != "FEATURES"
        write_results(
            target,
            found,
            result.colours,
            result.report,
            value=request.value,
            patches=patches,
            part=part,
            carried=result.carried,
            live=request.live,
        )
        if self.straightened:
            *shapes, some = shapes
            refill_key(target, some, self.straightened)
        if shapes:
            write_in_betweens(target, shapes)

    def _form(
        self,
        whole: Combined,
        settings: Settings,
        request: Request,
        progress: Progress | None,
        cancelled: Cancelled | None,
    ) -> CanonicalForm:
        """Compute the form; unless it is to lie as posed, compute it as the objects are placed in the scene."""
        from ...core import canonical_form

        alone = len(self.readings) == 1
        turn = world_rotation(self.readings[0].placement) if alone else np.eye(3)
        how: dict[str, Any] = {"rest": whole.rest, "progress": progress, "cancelled": cancelled}
        if request.keep is not None and not settings.whole:  # keeping all pairs would take gigabytes
            how["keep"] = request.keep.part(names_of(self.readings))
        if settings.orientation == "posed" and request.reference is None:
            found = canonical_form(whole.vertices, whole.faces, settings, **how)
            self.whole_form = replace(found, vertices=found.vertices @ turn.T)
            return found
        self._require_no_mirror(
            told(
                "{name} has a Mirror modifier, and its form has to stay on the mirror. Set Mesh to As Shown, or "
                "Orientation to As Posed and no Reference.",
                name=self.name,
            )
        )
        posed = whole.vertices @ turn.T
        reference = None if request.reference is None else request.reference(cancelled)
        found = canonical_form(posed, whole.faces, settings, reference=reference, **how)
        self.whole_form = found
        form = found.vertices if alone else found.vertices + (posed.mean(axis=0) - found.vertices.mean(axis=0))
        return turned(replace(found, vertices=form), turn)

    def _require_no_mirror(self, reason: str) -> None:
        """Reject base meshes that have a mirror image shown by a modifier."""
        if any(reading.mirrors for reading in self.readings):
            raise CanonicalFormError(reason)


def _before_modifiers(
    obj: bpy.types.Object, found: AnyResult, shapes: list[FloatArray]
) -> tuple[AnyResult, list[FloatArray]]:
    """Return the form and in-between shapes from which the modifiers produce the computed shapes."""
    form, *between = positions_before(obj, [found.vertices, *shapes])  # type: ignore[union-attr]
    return replace(found, vertices=form), between  # type: ignore[arg-type, call-arg]
