"""The main job: objects in, forms computed apart from Blender, results out; every object keeps its mode."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy

from ..core import CanonicalFormError
from .advice import explained
from .form_item import FormItem
from .object_states import object_mode
from .request import Request

if TYPE_CHECKING:
    from ..core import CanonicalForm, FeaturePatches
    from ..core.run.monitor import Cancelled, Progress
    from .form_report import FormReport


class FormTask:
    """The forms of some objects.

    The constructor reads the objects, `compute` may run in any thread, and `write` writes the results. Nothing is
    written before everything is computed, so an error or a cancellation leaves the meshes as they were.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects accepted by `refusal`, the active one first; of those that share a mesh the first is taken.
    request : Request
        What is to be computed.

    Attributes
    ----------
    items : list of FormItem
        One item for each object that could be read.

    Raises
    ------
    CanonicalFormError
        If an object cannot leave its mode, or the request does not suit the only object.
    """

    def __init__(self, objects: Sequence[bpy.types.Object], request: Request) -> None:
        self.request = request
        self.items: list[FormItem] = []
        self._unread: list[str] = []
        separate = request.deformed or request.new_object  # objects that share a mesh have results of their own
        first = {obj if separate else obj.data: obj for obj in reversed(objects)}
        with object_mode(objects[0]):
            for obj in reversed(list(first.values())):
                try:
                    self.items.append(FormItem.read(obj, request))
                except CanonicalFormError as error:
                    if len(first) == 1:
                        raise
                    self._unread.append(explained(error))

    @property
    def taken(self) -> set[str]:
        """Names of the objects that were read; a result on another one is on a new object."""
        return {item.reading.name for item in self.items}

    @property
    def errors(self) -> list[str]:
        """Sentences about the objects that could not be read, computed or written."""
        return [*self._unread, *(item.error for item in self.items if item.error is not None)]

    @property
    def written(self) -> dict[str, FormReport]:
        """Reports of the results that were written, by the name of the object that shows them."""
        return {
            item.written_to: item.result.report
            for item in self.items
            if item.result is not None and item.written_to is not None
        }

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute all results; touches no data of Blender's.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `canonical_form`.

        Raises
        ------
        CanonicalFormError
            If the only mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        count = len(self.items)
        for number, item in enumerate(self.items):

            def report(done: float, stage: str, number: int = number, name: str = item.reading.name) -> None:
                if progress is not None:
                    progress((number + done) / count, stage if count == 1 else f"{name}: {stage}")

            try:
                item.compute(self.request, report, cancelled)
            except CanonicalFormError as error:
                if count == 1 or (cancelled is not None and cancelled()):
                    raise
                item.error = f"{item.reading.name}: {explained(error)}"

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
        for item in self.items:
            try:
                item.write(self.request)
            except CanonicalFormError as error:
                item.error = explained(error)
        if not self.written:
            raise CanonicalFormError(" ".join(self.errors))
        return list(self.written)


def compute_on(
    obj: bpy.types.Object,
    request: Request,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> tuple[CanonicalForm | FeaturePatches, FormReport]:
    """Compute the canonical form of one object and write it there, at once.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`; in any mode.
    request : Request
        What is to be computed.
    progress, cancelled : callable, optional
        As in `canonical_form`.

    Returns
    -------
    found : CanonicalForm or FeaturePatches
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
    result = task.items[0].result
    assert result is not None  # compute raises for a single object
    return result.found, result.report
