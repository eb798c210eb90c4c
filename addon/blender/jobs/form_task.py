"""The main job: reads objects, computes forms without Blender, writes results; every object keeps its mode."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import bpy

from ...core import CanonicalFormError, InvalidMeshError
from ..objects.bone_reading import with_bones
from ..objects.combining import touching
from ..objects.object_states import muted_results, object_mode, unrefined
from ..objects.rest_reading import with_rests
from ..words.advice import explained
from ..words.wording import progress_of, told
from .form_item import FormItem
from .request import Request

if TYPE_CHECKING:
    from ...core.results import AnyResult
    from ...core.run.monitor import Cancelled, Progress
    from ..records.form_report import FormReport


class FormTask:
    """The forms of some objects.

    The constructor reads the objects, `compute` may run in any thread, and `write` writes the results. Nothing is
    written until everything is computed, so an error or a cancellation leaves the meshes unchanged.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects accepted by `refusal`, the active one first; of objects that share a mesh, the first is used.
    request : Request
        What to compute.

    Attributes
    ----------
    items : list of FormItem
        One item for each object that could be read; after the computation, for each body.

    Raises
    ------
    CanonicalFormError
        If an object cannot leave its mode, or the request cannot be applied to the only object.
    """

    def __init__(self, objects: Sequence[bpy.types.Object], request: Request) -> None:
        self.request = request
        self.items: list[FormItem] = []
        self._unread: list[str] = []
        # objects that share a mesh have separate results unless the mesh holds them
        separate = request.new_object or request.deformed
        first = {obj if separate else obj.data: obj for obj in reversed(objects)}
        taken = list(reversed(first.values()))
        together = request.objects != "EACH"
        meshes: dict[bpy.types.Mesh, str] = {}  # meshes that hold a result, and its object
        read: list[bpy.types.Object] = []
        with (
            object_mode(objects[0]),
            muted_results(obj.data for obj in taken if request.deformed),
            unrefined(taken if request.unrefined else ()),
        ):
            for obj in taken:
                try:
                    item = FormItem.read(obj, request)
                except CanonicalFormError as error:
                    if len(first) == 1:
                        raise
                    self._unread.append(explained(error))
                    continue
                held = not request.new_object and len(item.readings[0].vertices) == len(obj.data.vertices)
                if not held or meshes.setdefault(obj.data, obj.name) == obj.name:
                    self.items.append(item)
                    read.append(obj)
            pairs = list(zip(read, self.items, strict=True))
            for group in [pairs] if together else [[pair] for pair in pairs]:
                there = [obj for obj, _ in group]
                rested = with_rests(there, [item.readings[0] for _, item in group])
                if request.likeness is not None and request.likeness.by_bones:
                    rested = with_bones(there, rested)
                for (_, item), reading in zip(group, rested, strict=True):
                    item.readings = [reading]
        for obj in objects if together else taken:
            if meshes.get(obj.data, obj.name) != obj.name:
                self._unread.append(
                    told(
                        "{name} has the mesh of {other} and shows the same form.", name=obj.name, other=meshes[obj.data]
                    )
                )
        if len(self.items) == 1:
            request.require_points(self.items[0].name, self.items[0].chosen)

    @property
    def taken(self) -> set[str]:
        """Names of the objects that were read; any other object with a result is new."""
        return {reading.name for item in self.items for reading in item.readings}

    @property
    def resized(self) -> list[str]:
        """Names of the objects whose modifiers change the number of vertices, so that no shape key can hold a form."""
        return [name for item in self.items for name in item.resized]

    @property
    def errors(self) -> list[str]:
        """Messages about the objects that could not be read, computed or written."""
        return [*self._unread, *(item.error for item in self.items if item.error is not None)]

    @property
    def written(self) -> dict[str, FormReport]:
        """Reports of the results that were written, by the name of the object that shows them."""
        return {
            name: result.report
            for item in self.items
            for name, result in zip(item.written_to, item.results, strict=False)
        }

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute all results; does not access Blender's data.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CanonicalFormError
            If the only mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        self._join(cancelled)
        count = len(self.items)
        for number, item in enumerate(self.items):
            try:
                item.compute(self.request, progress_of(progress, item.name, number, count), cancelled)
            except CanonicalFormError as error:
                if count == 1 or (cancelled is not None and cancelled()):
                    raise
                item.error = f"{item.name}: {explained(error)}"

    def write(self) -> list[str]:
        """Write the results, in the main thread.

        Returns
        -------
        list of str
            Names of the objects that show results.

        Raises
        ------
        CanonicalFormError
            If nothing could be written; the message says why.
        """
        computed = [item for item in self.items if item.results]
        self._try_each(computed, lambda item: item.require_unchanged(self.request), muted=self.request.deformed)
        ready = [item for item in computed if item.error is None]
        taken = self.taken
        self._try_each(ready, lambda item: item.write(self.request, taken))
        if not self.written:
            raise CanonicalFormError(" ".join(self.errors))
        return list(self.written)

    def _join(self, cancelled: Cancelled | None) -> None:
        """Join the items of each body into one; unusable items stay separate."""
        if self.request.objects == "EACH" or len(self.items) < 2:
            return
        broken = [item for item in self.items if not _is_usable(item)]
        sound = [item for item in self.items if item not in broken]
        groups = [list(range(len(sound)))] if sound else []
        if self.request.objects == "TOUCHING" and len(sound) > 1:
            try:
                readings = [item.readings[0] for item in sound]
                groups = touching(readings, together=self.request.settings.together, cancelled=cancelled)
            except InvalidMeshError as error:
                self._unread.append(
                    told(
                        "The objects were computed one by one, since together they cannot be. {error}",
                        error=explained(error),
                    )
                )
                return
        self.items = [FormItem.joined([sound[index] for index in group], self.request) for group in groups] + broken
        for item in self.items:
            item.bodies = len(groups)

    @staticmethod
    def _try_each(items: list[FormItem], work: Callable[[FormItem], None], *, muted: bool = False) -> None:
        """Call a function on each item; store the error of those that fail."""
        names = [reading.name for item in items for reading in item.readings if muted]
        there = [bpy.data.objects[name].data for name in names if name in bpy.data.objects]
        with muted_results(mesh for mesh in there if isinstance(mesh, bpy.types.Mesh)):
            for item in items:
                try:
                    work(item)
                except CanonicalFormError as error:
                    item.error = explained(error)


def _is_usable(item: FormItem) -> bool:
    """Return whether the mesh of an object can be used; the computation reports why it cannot."""
    from ...core.assembly.pieces import connected_pieces

    try:
        connected_pieces(item.readings[0].vertices, item.readings[0].faces)
    except InvalidMeshError:
        return False
    return True


def compute_on(
    obj: bpy.types.Object,
    request: Request,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> tuple[AnyResult, FormReport]:
    """Compute the canonical form of one object and write it, without a background job.

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
    found : CanonicalForm, PosedLike or FeaturePatches
        The result.
    report : FormReport
        Counts, stress, measures, timings and warnings.

    Raises
    ------
    CanonicalFormError
        If the mesh cannot be used, or the run was cancelled; the message names the remedy.
    """
    task = FormTask([obj], request)
    task.compute(progress, cancelled)
    task.write()
    (result,) = task.items[0].results  # compute raises an error for a single object
    return result.found, result.report
