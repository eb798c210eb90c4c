"""Operators whose work runs in a thread while Blender stays usable, and the one that cancels it."""

from __future__ import annotations

from time import perf_counter
from typing import Any, ClassVar

import bpy

from ..blender.jobs import Job
from ..core import CancelledError, CanonicalFormError

_TICK = 0.1  # seconds between two looks at the job
_REDRAW = 0.25  # seconds between two drawings of its progress: the sidebar takes the view behind it along
_PATIENCE = 0.4  # seconds to wait for a cancelled job before it is left to end by itself
_NO_MEMORY = "The memory of this machine is not enough. Close other files, or decimate the mesh."
_BUSY = ("TRANSFORM_OT_", "SCULPT_OT_", "PAINT_OT_", "MESH_OT_", "GPENCIL_OT_", "PAINTCURVE_OT_")  # hold mesh data


class OBJECT_OT_canonical_form_cancel(bpy.types.Operator):
    """Stop the computation; nothing is changed"""  # noqa: D400 (Blender's tooltip)

    bl_idname = "object.canonical_form_cancel"
    bl_label = "Cancel Canonical Form"
    bl_options = {"INTERNAL"}

    job: ClassVar[Job | None] = None  # the one computation under way
    timer: ClassVar[bpy.types.Timer | None] = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Allow it while something is computed."""
        if cls.job is None:
            cls.poll_message_set("Nothing is being computed.")
        return cls.job is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Ask the computation to stop."""
        if self.job is not None:
            self.job.stop()
        return {"FINISHED"}


class JobOperator:
    """Mixed into operators that compute: at once when called by a script, in a thread when called by a button.

    A subclass says what the task is (`task`: an object with ``compute(progress, cancelled)``, which touches arrays
    only, and ``write()``) and tells the user what came of it (`written`).
    """

    def task(self, context: bpy.types.Context) -> Any:
        """Read what the work needs; raises `CanonicalFormError` with a sentence where it cannot be done."""
        raise NotImplementedError

    def written(self, context: bpy.types.Context, task: Any, outcome: Any, interactive: bool) -> None:
        """Tell the user what came of it."""

    def _failed(self, error: Exception) -> set[str]:
        """Show why there is no result."""
        sentence = _NO_MEMORY if isinstance(error, MemoryError) else str(error)
        self.report({"ERROR"}, sentence)  # type: ignore[attr-defined]
        return {"CANCELLED"}

    def warn(self, sentences: list[str]) -> None:
        """Show warnings of a computation."""
        for sentence in sentences:
            self.report({"WARNING"}, sentence)  # type: ignore[attr-defined]

    @staticmethod
    def busy() -> str | None:
        """Say that something is being computed already, for `poll`."""
        if OBJECT_OT_canonical_form_cancel.job is None:
            return None
        return "A computation is under way. Wait for it, or cancel it with Esc."

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Do all of it at once."""
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            task = self.task(context)
            task.compute(lambda done, _: manager.progress_update(100 * done))
            self.written(context, task, task.write(), interactive=False)
        except (CanonicalFormError, MemoryError) as error:
            return self._failed(error)
        finally:
            manager.progress_end()
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Start the work in a thread and watch it."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self._task = self.task(context)
        except (CanonicalFormError, MemoryError) as error:
            return self._failed(error)
        self._job, self._stopped_at = Job(self._task.compute), 0.0
        OBJECT_OT_canonical_form_cancel.job = self._job
        OBJECT_OT_canonical_form_cancel.timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        show_progress(context, self._job)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Let every event pass but Esc; when the work is done, write its result."""
        if event.type == "ESC" and event.value == "PRESS":
            self._job.stop()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._job.stopped:
            self._stopped_at = self._stopped_at or perf_counter()
            if self._job.running and perf_counter() - self._stopped_at < _PATIENCE:
                return {"PASS_THROUGH"}
        elif self._job.running or _user_is_busy(context):
            show_progress(context, self._job)
            return {"PASS_THROUGH"}
        end_job(context)
        try:
            self._job.result()
            self.written(context, self._task, self._task.write(), interactive=True)
        except CancelledError as error:
            self.report({"INFO"}, str(error))  # type: ignore[attr-defined]
            return {"CANCELLED"}
        except (CanonicalFormError, MemoryError) as error:
            return self._failed(error)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stop the work where Blender ends the operator: another file is opened, the window is closed."""
        self._job.stop()
        end_job(context)


def show_progress(context: bpy.types.Context, job: Job) -> None:
    """Show in the status bar how far the job is, and have the panels drawn anew.

    Parameters
    ----------
    context : bpy.types.Context
        The context of the operator.
    job : Job
        The job.
    """
    if perf_counter() - job.shown_at < _REDRAW:
        return
    job.shown_at = perf_counter()
    if context.workspace is not None:
        context.workspace.status_text_set(f"Canonical Form: {job.fraction:.0%} {job.stage}   (Esc to cancel)")
    redraw_sidebars(context)


def end_job(context: bpy.types.Context) -> None:
    """Forget the job and clear what showed its progress.

    Parameters
    ----------
    context : bpy.types.Context
        The context of the operator.
    """
    cancel = OBJECT_OT_canonical_form_cancel
    if cancel.timer is not None:
        context.window_manager.event_timer_remove(cancel.timer)
    cancel.job = cancel.timer = None
    if context.workspace is not None:
        context.workspace.status_text_set(None)
    redraw_sidebars(context)


def redraw_sidebars(context: bpy.types.Context) -> None:
    """Have the sidebars of all 3D Views drawn anew.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.
    """
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions if area.type == "VIEW_3D" else ():
                if region.type == "UI":
                    region.tag_redraw()


def _user_is_busy(context: bpy.types.Context) -> bool:
    """Tell whether the user is in the middle of a stroke or a transform, which must not lose its mesh."""
    return any(running.bl_idname.startswith(_BUSY) for running in context.window.modal_operators)


CLASSES = (OBJECT_OT_canonical_form_cancel,)


def register() -> None:
    """Register the operator."""
    for each in CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Stop what is under way and unregister the operator."""
    if OBJECT_OT_canonical_form_cancel.job is not None:
        OBJECT_OT_canonical_form_cancel.job.stop()
        end_job(bpy.context)
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
