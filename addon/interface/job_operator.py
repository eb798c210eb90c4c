"""The base of operators that compute in a thread while Blender stays responsive, and the operator that cancels them."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import Any, ClassVar, NamedTuple

import bpy

from ..blender.jobs.job import Job
from ..blender.jobs.meant_objects import meant_object
from ..blender.words.advice import MENDS, explained
from ..blender.words.wording import CONTEXT, told
from ..core import CancelledError, CanonicalFormError, KeptStages

_TICK = 0.1  # seconds between two timer events
_REDRAW = 0.25  # seconds between two redraws of the progress, as a redraw of the sidebar also redraws the view
_BAR = 8  # width of the bar in the status bar, in buttons
_CANCEL_TIMEOUT = 0.4  # seconds to wait for a cancelled job before it is abandoned
_KEPT_VERTICES = 1_000_000  # largest total size of objects with stages kept for the next run: 0.3 to 0.7 kB per vertex
_HOLDING_MESH = (
    "TRANSFORM_OT_",
    "SCULPT_OT_",
    "PAINT_OT_",
    "MESH_OT_",
    "GPENCIL_OT_",
    "PAINTCURVE_OT_",
)  # modal operators


class Refusal(NamedTuple):
    """What was asked for last and refused.

    Attributes
    ----------
    owner : str
        Name of the object.
    wish : str
        What was asked for, as operators call it.
    sentence : str
        Why it was refused.
    mend : str
        What mends it, as in `advice.MENDS`; empty if no button does.
    """

    owner: str
    wish: str
    sentence: str
    mend: str


class OBJECT_OT_canonical_form_cancel(bpy.types.Operator):
    """Stop the computation; nothing is changed"""  # noqa: D400 (Blender's tooltip)

    bl_idname = "object.canonical_form_cancel"
    bl_label = "Cancel Canonical Form"
    bl_translation_context = CONTEXT
    bl_options = {"INTERNAL"}

    job: ClassVar[Job | None] = None  # the running computation; only one at a time
    wish: ClassVar[str] = ""  # what was asked for: the row of the panel that shows its progress
    began: ClassVar[float] = 0.0
    timer: ClassVar[bpy.types.Timer | None] = None
    refused: ClassVar[Refusal | None] = None  # told in the panel until something else is asked for
    kept: ClassVar[tuple[list[str], KeptStages] | None] = (
        None  # of the objects that the last run worked on, with their names
    )

    @classmethod
    def seconds_left(cls, now: float) -> float:
        """Estimate how long the job takes still, by how far it is.

        Parameters
        ----------
        now : float
            The time, of `perf_counter`.

        Returns
        -------
        float
            Seconds; 0 without a job.
        """
        if cls.job is None or not cls.job.fraction or not cls.began:
            return 0.0
        return (now - cls.began) * (1 - cls.job.fraction) / cls.job.fraction

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Enable the button while a computation is running."""
        if cls.job is None:
            cls.poll_message_set("Nothing is being computed.")
        return cls.job is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Cancel the computation."""
        if self.job is not None:
            self.job.stop()
        return {"FINISHED"}


class JobOperator:
    """Mixin for operators that compute: directly when called from a script, in a thread when called from a button.

    A subclass creates the task (`task`: an object with ``compute(progress, cancelled)``, which accesses only arrays,
    and ``write()``) and reports its result to the user (`written`).
    """

    def wish(self) -> str:
        """Name what is asked for, by which the panel finds the row that shows the progress.

        Returns
        -------
        str
            A word of its own; empty for what has no row.
        """
        return ""

    def task(self, context: bpy.types.Context) -> Any:
        """Create the task.

        Parameters
        ----------
        context : bpy.types.Context
            The context of the operator.

        Returns
        -------
        object
            The task, with everything it needs already read from Blender's data.

        Raises
        ------
        CanonicalFormError
            If the task cannot be carried out; the message names the remedy.
        """
        raise NotImplementedError

    def written(self, context: bpy.types.Context, task: Any, outcome: Any, interactive: bool) -> None:
        """Report the result to the user.

        Parameters
        ----------
        context : bpy.types.Context
            The context at the end of the computation; another object may be active by then.
        task : object
            The task that `task` returned.
        outcome : object
            Return value of the task's ``write()``.
        interactive : bool
            Whether the operator was called from a button.
        """

    def _begin(self, context: bpy.types.Context) -> None:
        """Remember whom a refusal will be about; another object may be active by then."""
        obj = meant_object(context)
        self._owner = "" if obj is None else obj.name
        OBJECT_OT_canonical_form_cancel.refused = None

    def _failed(self, error: Exception) -> set[str]:
        """Report why there is no result."""
        sentence = explained(error)
        kind = getattr(error.args[0], "kind", "") if error.args else ""
        OBJECT_OT_canonical_form_cancel.refused = Refusal(self._owner, self.wish(), sentence, MENDS.get(kind, ""))
        self.report({"ERROR"}, sentence)  # type: ignore[attr-defined]
        return {"CANCELLED"}

    def warn(self, sentences: list[str]) -> None:
        """Report warnings.

        Parameters
        ----------
        sentences : list of str
            The warnings.
        """
        for sentence in sentences:
            self.report({"WARNING"}, sentence)  # type: ignore[attr-defined]

    @staticmethod
    def busy() -> str | None:
        """Return why no computation can start, for use in `poll`.

        Returns
        -------
        str or None
            A sentence; None if no computation is running.
        """
        if OBJECT_OT_canonical_form_cancel.job is None:
            return None
        return told("A computation is under way. Wait for it, or cancel it with Esc.")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Compute and write without a thread."""
        manager = context.window_manager
        self._begin(context)
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
        """Start the computation in a thread and run modally until it ends."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._begin(context)
        try:
            self._task = self.task(context)
        except (CanonicalFormError, MemoryError) as error:
            return self._failed(error)
        self._job, self._stopped_at = Job(self._task.compute), 0.0
        OBJECT_OT_canonical_form_cancel.job = self._job
        OBJECT_OT_canonical_form_cancel.wish, OBJECT_OT_canonical_form_cancel.began = self.wish(), perf_counter()
        OBJECT_OT_canonical_form_cancel.timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        show_progress(context, self._job)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Pass through all events except Esc; write the result at the end of the computation."""
        if event.type == "ESC" and event.value == "PRESS":
            self._job.stop()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._job.stopped:
            self._stopped_at = self._stopped_at or perf_counter()
            if self._job.running and perf_counter() - self._stopped_at < _CANCEL_TIMEOUT:
                return {"PASS_THROUGH"}
        elif self._job.running or user_is_busy(context):
            show_progress(context, self._job)
            return {"PASS_THROUGH"}
        end_job(context)
        try:
            self._job.result()
            self.written(context, self._task, self._task.write(), interactive=True)
            redraw_sidebars(context)
        except CancelledError as error:
            self.report({"INFO"}, str(error))  # type: ignore[attr-defined]
            return {"CANCELLED"}
        except (CanonicalFormError, MemoryError) as error:
            return self._failed(error)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Cancel the job when Blender ends the operator because another file is opened or the window is closed."""
        self._job.stop()
        end_job(context)


def show_progress(context: bpy.types.Context, job: Job) -> None:
    """Show the progress of a job in the status bar and in the sidebars.

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
        context.workspace.status_text_set(_draw_status)
    redraw_sidebars(context)


def _draw_status(header: bpy.types.Header, _context: bpy.types.Context) -> None:
    """Draw the progress into the status bar."""
    job = OBJECT_OT_canonical_form_cancel.job
    if job is not None:
        row = header.layout.row()
        row.label(text="Canonical Form")
        bar = row.row()
        bar.ui_units_x = _BAR
        bar.progress(factor=job.fraction, text=f"{job.fraction:.0%}", type="BAR")
        row.label(text=told("Cancel"), icon="EVENT_ESC")


def end_job(context: bpy.types.Context) -> None:
    """Clear the current job, its timer and its progress display.

    Parameters
    ----------
    context : bpy.types.Context
        The context of the operator.
    """
    cancel = OBJECT_OT_canonical_form_cancel
    if cancel.timer is not None:
        context.window_manager.event_timer_remove(cancel.timer)
    cancel.job = cancel.timer = None
    cancel.wish, cancel.began = "", 0.0
    if context.workspace is not None:
        context.workspace.status_text_set(None)
    redraw_sidebars(context)


def redraw_sidebars(context: bpy.types.Context) -> None:
    """Tag the sidebars of all 3D Views for redrawing.

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


def kept_stages(objects: Sequence[bpy.types.Object]) -> KeptStages | None:
    """Return the stages kept from earlier runs on the same objects, so that only changes are computed again.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects. Stages of other objects are dropped.

    Returns
    -------
    KeptStages or None
        The kept stages; None in background mode, where scripts process many files, and for very large meshes.
    """
    registry = OBJECT_OT_canonical_form_cancel
    if bpy.app.background or sum(len(obj.data.vertices) for obj in objects) > _KEPT_VERTICES:
        registry.kept = None
        return None
    names = sorted(obj.name_full for obj in objects)
    if registry.kept is None or registry.kept[0] != names:
        registry.kept = names, KeptStages()
    return registry.kept[1]


@bpy.app.handlers.persistent
def _forget(*_: object) -> None:
    """Drop what is kept from another file."""
    OBJECT_OT_canonical_form_cancel.kept = OBJECT_OT_canonical_form_cancel.refused = None


def user_is_busy(context: bpy.types.Context) -> bool:
    """Return whether a stroke or transform is running, during which the mesh must not change.

    Parameters
    ----------
    context : bpy.types.Context
        A context with a window.

    Returns
    -------
    bool
        True if one is running.
    """
    return any(running.bl_idname.startswith(_HOLDING_MESH) for running in context.window.modal_operators)


CLASSES = (OBJECT_OT_canonical_form_cancel,)


def register() -> None:
    """Register the operator, and drop kept stages when another file is opened."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.app.handlers.load_post.append(_forget)


def unregister() -> None:
    """Cancel the current job and unregister the operator."""
    if OBJECT_OT_canonical_form_cancel.job is not None:
        OBJECT_OT_canonical_form_cancel.job.stop()
        end_job(bpy.context)
    bpy.app.handlers.load_post.remove(_forget)
    _forget()
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
