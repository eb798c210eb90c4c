"""The main operators: compute canonical forms, and clear their results."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import TYPE_CHECKING, Any

import bpy
from bpy.props import EnumProperty

from ..blender.jobs.meant_objects import meant_object, meant_objects
from ..blender.objects.mesh_reading import refusal
from ..blender.objects.movers import is_any_moved
from ..blender.records.record import read_record
from ..blender.results.new_objects import make_active
from ..blender.words.advice import explained
from ..blender.words.wording import CONTEXT, counted_points, listed, told
from ..core import CanonicalFormError
from .job_operator import JobOperator, kept_stages
from .preferences import show_colours_if_wished
from .properties import PART_ITEMS, MethodProperties, RequestProperties, list_patches, settings_of
from .viewport import any_result, restore_shading, show_colours

if TYPE_CHECKING:
    from ..blender.jobs.form_task import FormTask
    from ..blender.jobs.request import Request
    from ..blender.records.form_report import FormReport
    from ..core import KeptStages


class OBJECT_OT_canonical_form(JobOperator, MethodProperties, RequestProperties, bpy.types.Operator):
    """Take the pose out of the selected meshes, or of one limb, as a shape key. Limbs can be chosen later, too"""  # noqa: D400

    bl_idname = "object.canonical_form"
    bl_label = "Canonical Form"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    step: EnumProperty(  # type: ignore[valid-type]
        name="Step",
        translation_context=CONTEXT,
        description="Last step of the run",
        items=(
            ("FORM", "Form", "Compute the form"),
            ("PATCHES", "Patches", "Feature points and patches only"),
            ("FEATURES", "Feature Points", "Feature points only"),
        ),
        default="FORM",
    )
    limb: EnumProperty(  # type: ignore[valid-type]
        name="Limb",
        translation_context=CONTEXT,
        description="What is straightened; limbs can be chosen afterwards, too",
        items=PART_ITEMS,
        default="ALL",
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Return the tooltip of the button."""
        if properties.step == "FEATURES":
            return told("Find the feature points and stop there. An earlier form of the mesh is removed")
        if properties.step == "PATCHES":
            return told("Find the feature points and patches and stop there. An earlier form of the mesh is removed")
        return told(cls.__doc__ or "")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, cls.busy() or refusal(meant_object(context)))

    def wish(self) -> str:
        """Name the step."""
        return self.step

    def task(self, context: bpy.types.Context) -> "FormTask":
        """Read the active and the other selected meshes."""
        from ..blender.jobs.form_task import FormTask

        objects, self._refused = chosen_objects(context)
        return FormTask(objects, request_of(self, objects, self.step, kept=kept_stages(objects)))

    def written(self, context: bpy.types.Context, task: "FormTask", outcome: list[str], interactive: bool) -> None:
        """Report the warnings, then summarise the results in one line."""
        tell_results(self, context, task, self._refused, interactive)


class OBJECT_OT_canonical_form_clear(bpy.types.Operator):
    """Remove the shape keys, vertex groups and colours that Canonical Form wrote, and nothing else"""  # noqa: D400

    bl_idname = "object.canonical_form_clear"
    bl_label = "Clear Canonical Form"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is nothing to clear."""
        return allowed(cls, JobOperator.busy() or result_refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove the results, including those of companions."""
        from ..blender.results.result_clearing import clear_from

        objects = [obj for obj in meant_objects(context) if obj.type == "MESH" and read_record(obj.data) is not None]
        reasons = [reason for obj in objects if obj.data.polygons and (reason := refusal(obj)) is not None]
        if reasons:
            self.report({"ERROR"}, told("{reason} Nothing was cleared.", reason=reasons[0]))
            return {"CANCELLED"}
        for obj in objects:
            try:
                left = clear_from(obj)
            except CanonicalFormError as error:
                self.report({"ERROR"}, explained(error))
                return {"CANCELLED"}
            list_patches(obj.data)
            if left:
                self.report({"WARNING"}, told("Kept, since they may hold your changes: {left}.", left=listed(left)))
        if not any_result():
            restore_shading(context)
        return {"FINISHED"}


def request_of(
    owner: Any,
    objects: list[bpy.types.Object],
    step: str = "FORM",
    *,
    kept: "KeptStages | None" = None,
    live: bool = False,
) -> "Request":
    """Convert properties to a request.

    Parameters
    ----------
    owner : MethodProperties and RequestProperties
        An operator, or an object filled by `hand_over`.
    objects : list of bpy.types.Object
        What it is about.
    step : str
        The last step of the run.
    kept : KeptStages, optional
        Stages kept from earlier runs on the objects.
    live : bool
        Whether to update a form only.

    Returns
    -------
    Request
        The request.

    Raises
    ------
    CanonicalFormError
        If the options are invalid, or the reference cannot be used; the message says why.
    """
    from ..blender.jobs.reference import Reference
    from ..blender.jobs.request import Request

    deformed = takes_shown(owner.mesh, objects) and (step == "FORM" or owner.mesh == "SHOWN")
    return Request(
        settings=settings_of(owner),
        value=owner.value,
        step=step,
        feature_group=owner.feature_group,
        deformed=deformed,
        unrefined=deformed and leaves_refining_out(owner),
        new_object=owner.result == "OBJECT",
        objects=owner.objects,
        reference=Reference(owner.reference).computed if owner.reference and step == "FORM" else None,
        live=live,
        limb="" if live or step != "FORM" or owner.limb == "ALL" else owner.limb,
        keep=kept,
    )


def takes_shown(mesh: str, objects: list[bpy.types.Object]) -> bool:
    """Return whether meshes are taken as they are shown.

    Parameters
    ----------
    mesh : {'AUTO', 'BASE', 'SHOWN'}
        What was asked for.
    objects : list of bpy.types.Object
        The meshes.

    Returns
    -------
    bool
        True if they are asked for as shown, or something moves one of them.
    """
    return mesh == "SHOWN" or (mesh == "AUTO" and is_any_moved(objects))


def leaves_refining_out(owner: Any) -> bool:
    """Return whether what only refines a mesh is left out, so that a shape key can hold what it shows otherwise.

    Parameters
    ----------
    owner : RequestProperties
        An operator, or an object filled by `hand_over`.

    Returns
    -------
    bool
        True unless the mesh is asked for as shown, or the result goes to a new object.
    """
    return owner.mesh == "AUTO" and owner.result == "KEY"


def chosen_objects(context: bpy.types.Context) -> tuple[list[bpy.types.Object], list[str]]:
    """Return the usable objects among those that a run applies to.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    objects : list of bpy.types.Object
        The active one first.
    refused : list of str
        Messages about those that cannot be used.
    """
    first, *others = meant_objects(context)
    objects, refused = [first], []
    for obj in others:
        reason = refusal(obj)
        if reason is None:
            objects.append(obj)
        else:
            refused.append(reason)
    return objects, refused


def allowed(operator: type, reason: str | None) -> bool:
    """Set the tooltip of a disabled button to the reason.

    Parameters
    ----------
    operator : type
        The operator class, in its `poll`.
    reason : str or None
        Why the operator cannot be used; None if it can.

    Returns
    -------
    bool
        True if it can be used.
    """
    if reason is not None:
        operator.poll_message_set(reason)  # type: ignore[attr-defined]
    return reason is None


def result_refusal(obj: bpy.types.Object | None) -> str | None:
    """Return why there is no result of an object to work with.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object that is meant.

    Returns
    -------
    str or None
        A sentence for the user; None if there is one.
    """
    if obj is None or obj.type != "MESH" or read_record(obj.data) is None:
        return told("The active object has no canonical form.")
    return refusal(obj)


def tell_results(
    operator: JobOperator, context: bpy.types.Context, task: "FormTask", refused: list[str], interactive: bool
) -> None:
    """Report the warnings of a task, summarise its results in one line, and show them.

    Parameters
    ----------
    operator : JobOperator
        The operator that ran it.
    context : bpy.types.Context
        Its context.
    task : FormTask
        The task, with its results written.
    refused : list of str
        Messages about objects that were not part of it.
    interactive : bool
        Whether the operator was called from a button.
    """
    operator.warn([*refused, *task.errors])
    bodies = [item for item in task.items if item.written_to]
    for item in bodies:
        about = f"{item.name}: " if len(bodies) > 1 else ""
        operator.warn([about + warning for warning in item.results[0].report.warnings])
    for name in task.written:
        list_patches(bpy.data.objects[name].data)
    operator.report({"INFO"}, _summary(task))  # type: ignore[attr-defined]
    if interactive:
        if context.mode == "OBJECT":  # a script continues with its own selection
            make_active([bpy.data.objects[name] for name in task.written if name not in task.taken])
        if task.request.step == "PATCHES":  # there is nothing else to see
            show_colours(context)
        else:
            show_colours_if_wished(context)


def _summary(task: "FormTask") -> str:
    """Summarise the results in one line."""
    reports = [item.results[0].report for item in task.items if item.written_to]
    seconds = sum(report.seconds for report in reports)
    if len(reports) > 1:
        count = len(task.written)
        if len(reports) < count:
            return told("{count} objects as {bodies} bodies, {seconds:.1f} s.", count=count, bodies=len(reports),
                        seconds=seconds)  # fmt: skip
        return told("{count} objects, {seconds:.1f} s.", count=count, seconds=seconds)
    (report,), (name, *others) = reports, task.written
    sentence = _told_result(report, seconds)
    if name not in task.taken:
        where = told("{count} new objects", count=len(others) + 1) if others else name
        return told("{sentence} The result is on {where}.", sentence=sentence, where=where)
    if others:
        return told("{sentence} {count} objects are one body.", sentence=sentence, count=len(others) + 1)
    mesh = bpy.data.objects[name].data
    users = mesh.users - (1 if mesh.use_fake_user else 0)
    if users > 1:
        return told("{sentence} {users} objects share this mesh and show it.", sentence=sentence, users=users)
    return sentence


def _told_result(report: "FormReport", seconds: float) -> str:
    """Describe the result for one body."""
    if report.like is not None:
        if report.like.source == "bones":
            return told("{key}: by the bones of its rig, {seconds:.1f} s.", key=report.like.key, seconds=report.seconds)
        return told("{key}: {seconds:.1f} s.", key=report.like.key, seconds=report.seconds)
    return told("{points}, {seconds:.1f} s.", points=counted_points(len(report.feature_points)), seconds=seconds)


CLASSES = (OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
