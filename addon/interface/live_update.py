"""Live update: computes the form again, in a thread, whenever an option changes."""

from __future__ import annotations

import traceback
from time import perf_counter
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar

import bpy

from ..blender.jobs.job import Job
from ..blender.jobs.meant_objects import meant_meshes, meant_object
from ..blender.objects.body_points import body_points
from ..blender.objects.mesh_reading import refusal
from ..blender.records.record import RECORD_PROPERTY, read_record
from ..blender.words.advice import explained
from ..blender.words.wording import CONTEXT, listed, told
from ..core import CanonicalFormError
from .choices import choices_of, hand_over
from .job_operator import OBJECT_OT_canonical_form_cancel, kept_stages, redraw_sidebars, user_is_busy
from .operators import allowed, chosen_objects, request_of, takes_shown
from .preferences import show_colours_if_wished
from .properties import list_patches

if TYPE_CHECKING:
    from ..blender.jobs.form_task import FormTask

_TICK, _IDLE = 0.01, 0.1  # seconds between two checks, during a computation and otherwise
_SETTLED = 0.04  # seconds without reading or writing after a result, so that a dragged slider stays responsive


class LiveUpdate:
    """Watches the options in the panel, and computes the form of the object again when they change.

    Options are polled and compared, so changes by undo, scripts and drivers count too. If the object has a form, the
    constructor assumes that it shows the current options. The computation does not access Blender's data, and is
    cancelled if options change meanwhile. Only the first result has an undo step; undo and redo update later ones.

    Parameters
    ----------
    context : bpy.types.Context
        A context with a window.

    Attributes
    ----------
    state : str
        Current state, in one line for the panel.
    """

    def __init__(self, context: bpy.types.Context) -> None:
        self.state = told("Live: change an option")
        self._window = context.window.as_pointer()  # whose scene and active object are used
        self._job: Job | None = None
        self._task: FormTask | None = None
        self._began = 0.0
        self._name: str | None = None  # of the object that the options apply to
        self._shown: dict[str, Any] | None = None  # the options of the current result, or of the one being computed
        self._records: dict[str, str | None] = {}  # of the objects being processed, when they were read
        obj = meant_object(context)
        if obj is not None and _has_form(obj):
            self._name, self._shown = obj.name, _choices(context)

    def undone(self, context: bpy.types.Context) -> None:
        """Update the form after undo or redo, which may restore an older state; a removed form is not computed again.

        Parameters
        ----------
        context : bpy.types.Context
            Any context.
        """
        self.stop()
        obj = bpy.data.objects.get(self._name or "")
        self._shown = None if obj is not None and _has_form(obj) else _choices(context)

    def stop(self) -> None:
        """Cancel the current computation."""
        if self._job is not None:
            self._job.stop()
            self._shown = None

    def look(self) -> float:
        """Check whether the options have changed or a computation has ended.

        Returns
        -------
        float
            Seconds until the next check.
        """
        context = bpy.context
        windows = context.window_manager.windows
        if not windows:
            return _IDLE
        state = self.state
        window = next((each for each in windows if each.as_pointer() == self._window), windows[0])
        with context.temp_override(window=window):
            try:
                wait = self._step(context)
            except (CanonicalFormError, MemoryError) as error:
                self.state, wait = told("Live: {reason}", reason=explained(error)), _IDLE
            except Exception as error:  # Blender would silently remove a timer that raises an error
                traceback.print_exc()
                self.state, wait = (
                    told("Live: error in the extension, see the console: {error!r}", error=error),
                    _IDLE,
                )
            if state != self.state:
                redraw_sidebars(context)
        return wait

    def _step(self, context: bpy.types.Context) -> float:
        """Write a finished result, or start the next computation."""
        if OBJECT_OT_canonical_form_cancel.job is not None:  # another computation: only one at a time
            if self._job is not None:
                self.stop()
                self._shown = _choices(context)  # keep what the other computation writes
            return _IDLE
        if self._job is not None and self._job.running:
            if _choices(context) != self._shown:
                self.stop()
            return _TICK
        if user_is_busy(context):
            return _IDLE
        choices = _choices(context)
        job, self._job = self._job, None
        if job is not None and choices == self._shown and not job.stopped:
            self._write(context, job)
            return _SETTLED
        obj = meant_object(context)
        if obj is not None and obj.name != self._name:  # keep the form of another object until an option changes
            if self._name is not None:
                self._shown = choices
            self._name = obj.name
        if choices == self._shown:
            return _IDLE
        reason = _waits_for(context)
        if reason is not None:
            self.state = told("Live waits: {reason}", reason=reason)
            return _IDLE
        self._shown = choices
        self._begin(context, choices)
        return _TICK

    def _begin(self, context: bpy.types.Context, choices: dict[str, Any]) -> None:
        """Read the objects and start the computation."""
        from ..blender.jobs.form_task import FormTask

        self._began = perf_counter()
        objects, _ = chosen_objects(context)
        made = choices_of(context)
        value = 1.0 if made is None else made.value  # of new keys
        asked = SimpleNamespace(**choices, value=value)
        request = request_of(asked, objects, kept=kept_stages(objects), live=True)
        self._records = {obj.name: obj.data.get(RECORD_PROPERTY) for obj in objects}
        self._task = FormTask(objects, request)
        resized = self._task.resized
        if resized:  # each update would add an object
            raise CanonicalFormError(
                told(
                    "Modifiers change the number of vertices of {resized}, so there is no shape key to update. "
                    "Set Mesh to Base Mesh.",
                    resized=listed(resized),
                )
            )
        self._job = Job(self._task.compute)

    def _write(self, context: bpy.types.Context, job: Job) -> None:
        """Write the computed result."""
        job.result()
        task, self._task = self._task, None
        there = {obj.name: obj.data.get(RECORD_PROPERTY) for obj in bpy.data.objects if obj.name in self._records}
        if task is None or there != self._records:  # cleared, computed or changed meanwhile: keep that
            return
        first = not all(_has_form(obj) for obj in bpy.data.objects if obj.name in task.taken)
        for name in task.write():
            list_patches(bpy.data.objects[name].data)
        if first:  # a separate undo step, to return to after the first change of an option
            show_colours_if_wished(context)
            bpy.ops.ed.undo_push(message="Canonical Form Live Update")
        problems = task.errors
        self.state = (
            told("Live: {reason}", reason=problems[0])
            if problems
            else told("Live: {seconds:.2f} s", seconds=perf_counter() - self._began)
        )


class OBJECT_OT_canonical_form_live(bpy.types.Operator):
    """Live update: compute the form again as soon as an option changes. Press again to stop"""  # noqa: D400 (tooltip)

    bl_idname = "object.canonical_form_live"
    bl_label = "Canonical Form Live Update"
    bl_translation_context = CONTEXT
    bl_options: ClassVar[set[str]] = set()  # nothing to undo: its first result has a step of its own

    update: ClassVar[LiveUpdate | None] = None
    timer: ClassVar[Any] = None  # the function that Blender calls repeatedly, until another file is opened

    @classmethod
    def running(cls) -> LiveUpdate | None:
        """Return the live update that is running.

        Returns
        -------
        LiveUpdate or None
            The live update; None if there is none, or if it ended with an earlier file.
        """
        return cls.update if cls.timer is not None and bpy.app.timers.is_registered(cls.timer) else None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if nothing can be computed."""
        return allowed(cls, None if cls.running() else refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Start or stop the live update."""
        kind = OBJECT_OT_canonical_form_live
        if kind.running():
            kind.end()
            return {"FINISHED"}
        if bpy.app.background or context.window is None:
            self.report(
                {"ERROR"}, told("Live update needs a window. In a script, call the operator Canonical Form again.")
            )
            return {"CANCELLED"}
        choices = choices_of(context)
        if choices is not None and choices.result == "OBJECT":
            self.report({"ERROR"}, told("Live update changes a shape key. Set Written As to Shape Key."))
            return {"CANCELLED"}
        kind.end()
        kind.update = LiveUpdate(context)
        kind.timer = kind.update.look
        bpy.app.timers.register(kind.timer, first_interval=_IDLE)
        return {"FINISHED"}

    @classmethod
    def end(cls) -> None:
        """Stop the live update."""
        if cls.update is not None:
            cls.update.stop()
        if cls.timer is not None and bpy.app.timers.is_registered(cls.timer):
            bpy.app.timers.unregister(cls.timer)
        cls.update = cls.timer = None


def _choices(context: bpy.types.Context) -> dict[str, Any]:
    """Return the options in the panel that a form depends on."""
    made = choices_of(context)
    if made is None:
        return {}
    chosen = SimpleNamespace()
    hand_over(made, chosen)
    choices = vars(chosen)
    del choices["value"]  # the slider belongs to the user
    choices["result"] = "KEY"
    meshes = meant_meshes(context)
    points, by_hand = body_points(meshes)
    choices["points"] = points if by_hand else None  # dots that the user moves
    if takes_shown(chosen.mesh, meshes):
        choices["frame"] = context.scene.frame_current
    return choices


def _has_form(obj: bpy.types.Object) -> bool:
    """Return whether an object has a form."""
    record = read_record(obj.data) if obj.type == "MESH" else None
    return record is not None and record.report.has_form


def _waits_for(context: bpy.types.Context) -> str | None:
    """Return why nothing can be computed at present."""
    obj = meant_object(context)
    reason = refusal(obj)
    if reason is not None or obj is None:
        return reason
    if obj.mode != "OBJECT":
        return told("it works in Object Mode.")
    for each in chosen_objects(context)[0]:
        record = read_record(each.data)
        if record is not None and record.report.like is not None:
            return told("{name} shows another's pose.", name=each.name)
    return None


@bpy.app.handlers.persistent
def _after_undo(*_: object) -> None:
    """Notify the live update of undo or redo."""
    live = OBJECT_OT_canonical_form_live.running()
    if live is not None:
        live.undone(bpy.context)


@bpy.app.handlers.persistent
def _end(*_: object) -> None:
    """Stop the live update before another file is opened."""
    OBJECT_OT_canonical_form_live.end()


CLASSES = (OBJECT_OT_canonical_form_live,)


def register() -> None:
    """Register the operator, and the handlers for undo and for opening another file."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.app.handlers.load_pre.append(_end)
    bpy.app.handlers.undo_post.append(_after_undo)
    bpy.app.handlers.redo_post.append(_after_undo)


def unregister() -> None:
    """Stop the live update and unregister the operator."""
    bpy.app.handlers.redo_post.remove(_after_undo)
    bpy.app.handlers.undo_post.remove(_after_undo)
    bpy.app.handlers.load_pre.remove(_end)
    _end()
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
