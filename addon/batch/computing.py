"""Computes the forms of one file in Blender: opens the file, computes, writes, and returns result lines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import bpy
import numpy as np

from ..blender.files.face_indices import require_whole_faces
from ..blender.files.kinds_of_files import WRITTEN
from ..blender.files.reading_files import open_meshes, scripts_left_off
from ..blender.files.writing_files import Shown, save_blend, save_forms
from ..blender.jobs.form_item import FormItem
from ..blender.jobs.form_task import FormTask
from ..blender.jobs.likeness import Likeness
from ..blender.jobs.pose_reading import read_likeness
from ..blender.jobs.request import Request
from ..blender.objects.mesh_reading import refusal
from ..blender.results.frame_keys import keep_for_frame
from ..blender.results.result_clearing import clear_from
from ..blender.words.advice import explained
from ..core import CanonicalForm, CanonicalFormError
from ..core.method_api.costs import memory_estimate
from ..core.numerics.arrays import FloatArray
from .arguments import Wanted
from .lines import Line, complain, failure, stage_line
from .targets import Targets

_LEFT_OFF = (
    "Scripts or Python drivers in this file were left off; what they would move is not moved. "
    "If you trust the file, add --trust-scripts."
)
_PICTURES_LEFT_OUT = (
    "Pictures from outside the folder of this file were left out: {}. If you trust the file, add --trust-scripts."
)


def compute_in_blender(
    targets: Targets, wanted: Wanted, reference: CanonicalForm | Likeness | None = None
) -> Iterator[Line]:
    """Compute every mesh of a file, write the results, and report each.

    Parameters
    ----------
    targets : Targets
        The file, and the names of its results.
    wanted : Wanted
        What to do with the file.
    reference : CanonicalForm or Likeness, optional
        The form to align to, or the pose that is applied instead of computing a form.

    Yields
    ------
    dict
        A line for each result, each failure, and each existing result that was skipped.
    """
    path = targets.path
    try:
        if wanted.format not in WRITTEN:
            raise CanonicalFormError(f".{wanted.format} is written without Blender only. Choose obj or ply.")
        objects = _opened(path, wanted)
    except Exception as error:  # any error, as other files follow
        yield failure({"input": str(path)}, error, explained(error))
        return
    one_file = wanted.format == "blend" or wanted.together
    pending: list[Line] = []  # lines for the results in the next file to be saved
    for number, frame in enumerate(wanted.frames or (None,)):
        if frame is not None:
            if number and not wanted.frame_keys:  # results of earlier frames must be removed
                objects = _opened(path, wanted)
            bpy.context.scene.frame_set(frame)
        groups = [objects] if wanted.together else [[obj] for obj in objects]
        whole = targets.of_file(None if wanted.frame_keys else frame)
        if one_file and wanted.skip_existing and whole.exists():
            yield targets.skipped(whole, frame)
            continue
        alone = one_file or len(groups) == 1
        own = [whole] * len(groups) if alone else targets.of_objects([obj.name for obj in objects], frame)
        for group, target in zip(groups, own, strict=True):
            if not one_file and wanted.skip_existing and target.exists():
                pending.append(targets.skipped(target, frame))
                continue
            pending.append(_computed(targets, group, target, wanted, reference, frame))
        if wanted.frame_keys and frame != wanted.frames[-1]:
            continue
        yield from _saved(pending, whole, targets, wanted) if wanted.format == "blend" else pending
        pending = []


def reference_in_blender(path: Path, wanted: Wanted) -> CanonicalForm:
    """Compute the form of the largest mesh of a file, as a reference for others.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What to do with the other files.

    Returns
    -------
    CanonicalForm
        Its form, oriented as in the scene.

    Raises
    ------
    CanonicalFormError
        If the file cannot be read or the form cannot be computed.
    """
    objects = _opened_reference(path, wanted.trusted)
    objects = [obj for obj in objects if obj.name in wanted.objects] or objects
    if wanted.frames:
        bpy.context.scene.frame_set(wanted.frames[0])
    chosen = objects if wanted.together else [max(objects, key=lambda obj: len(obj.data.vertices))]
    reason = next((reason for obj in chosen if (reason := refusal(obj)) is not None), None)
    if reason is not None:
        raise CanonicalFormError(reason)
    task = FormTask(chosen, _request(wanted, None))
    task.compute()
    item = task.items[0]
    if item.error is not None or item.whole_form is None:
        raise CanonicalFormError(item.error or f"{path.name} has no form.")
    return item.whole_form


def likeness_in_blender(path: Path, names: Sequence[str], side: int, *, trusted: bool) -> Likeness:
    """Read the pose of the largest mesh of a file.

    Parameters
    ----------
    path : Path
        The file.
    names : sequence of str
        Names of the objects to use, as far as they exist.
    side : int
        Which way to match: -1 for the most likely, or its index.
    trusted : bool
        Whether scripts and Python drivers in a .blend file run.

    Returns
    -------
    Likeness
        The pose as shown in the file.

    Raises
    ------
    CanonicalFormError
        If the file cannot be read.
    """
    objects = _opened_reference(path, trusted)
    chosen = [obj for obj in objects if obj.name in names] or objects
    return read_likeness(max(chosen, key=lambda obj: len(obj.data.vertices)), side)


def _opened(path: Path, wanted: Wanted) -> list[bpy.types.Object]:
    """Open a file; objects that share a mesh count once if the mesh holds their result, or if their forms are equal."""
    held = wanted.format == "blend" if wanted.together else not wanted.shown
    objects = open_meshes(path, wanted.objects, shared=held, trusted=wanted.trusted)
    require_whole_faces(objects)
    for obj in objects if wanted.together and not held else ():  # two eyes: each has a form of its own
        if obj.data.users > 1:
            obj.data = obj.data.copy()
    return objects


def _opened_reference(path: Path, trusted: bool) -> list[bpy.types.Object]:
    """Open the reference file; blocked scripts are reported at once, as the reference has no result line."""
    objects = open_meshes(path, trusted=trusted)
    require_whole_faces(objects)
    edited = bpy.context.object
    if edited is not None and edited.mode != "OBJECT":  # as the file was saved; several objects may be in that mode
        bpy.ops.object.mode_set(mode="OBJECT")
    if scripts_left_off(path):
        complain(f"{path}: {_LEFT_OFF}")
    return objects


def _saved(lines: list[Line], whole: Path, targets: Targets, wanted: Wanted) -> list[Line]:
    """Save the file in its current state, with the results of all lines."""
    if all("error" in line for line in lines):
        return lines
    try:
        targets.require_new(whole)
        save_blend(whole, wanted.mark)
    except (CanonicalFormError, OSError, RuntimeError) as error:
        told = explained(error)
        return [line if "error" in line else failure(_head(line), error, told) for line in lines]
    return lines


def _request(wanted: Wanted, reference: CanonicalForm | Likeness | None) -> Request:
    """Create the request: shown meshes get a new object, as their number of vertices may differ."""
    form = None if isinstance(reference, Likeness) else reference
    return Request(
        wanted.settings,
        value=wanted.value,
        deformed=wanted.shown,
        new_object=wanted.shown and wanted.format != "blend",
        hausdorff=True,
        objects="TOGETHER" if wanted.together else "EACH",
        reference=None if form is None else lambda _cancelled: form,
        likeness=reference if isinstance(reference, Likeness) else None,
    )


def _computed(
    targets: Targets,
    group: Sequence[bpy.types.Object],
    target: Path,
    wanted: Wanted,
    reference: CanonicalForm | Likeness | None,
    frame: int | None,
) -> Line:
    """Compute one body, write it unless the whole file is saved later, and return its line."""
    first = group[0]
    path = targets.path
    line: Line = {"input": str(path), "object": first.name}
    if len(group) > 1:
        line["objects"] = [obj.name for obj in group]
    if frame is not None:
        line["frame"] = frame
    try:
        if first.name in bpy.context.view_layer.objects:
            bpy.context.view_layer.objects.active = first
        for obj in group:
            reason = refusal(obj)
            if reason is not None:
                raise CanonicalFormError(reason)
        if len(group) > 1 and wanted.format in ("obj", "ply"):
            raise CanonicalFormError(
                f".{wanted.format} holds one object. With --together choose blend, glb, fbx or usdc."
            )
        for obj in group if wanted.frame_keys and frame == wanted.frames[0] else ():
            clear_from(obj)  # a key per frame is not an update of one form
        memory = memory_estimate(sum(len(obj.data.vertices) for obj in group), wanted.settings)
        task = FormTask(group, _request(wanted, reference))
        if wanted.frame_keys:
            _require_keys(task)
        with stage_line(f"{path.name} {first.name} (about {memory:.1f} GB)", wanted.stages) as progress:
            task.compute(progress)
        task.write()
        if task.errors:
            raise CanonicalFormError(" ".join(task.errors))
        (item,) = task.items
        if frame is not None and wanted.frame_keys:
            for name in item.written_to:
                keep_for_frame(bpy.data.objects[name], frame, wanted.frames)
        if wanted.format != "blend":
            shown = [
                Shown(obj, _in_axes(result.found.vertices, obj, wanted), result.found.patches, result.colours.patches)  # type: ignore[union-attr]
                for obj, result in zip(map(bpy.data.objects.get, item.written_to), item.results, strict=True)
            ]
            targets.require_new(target)
            left_out = save_forms(target, shown, wanted.mark, pictures=None if wanted.trusted else path.parent)
            bpy.data.batch_remove([each.obj for each in shown if each.obj not in group])
            if left_out:
                item.results[0].report.warnings.append(_PICTURES_LEFT_OUT.format(", ".join(left_out)))
        report = item.results[0].report
        if scripts_left_off(path):
            report.warnings.append(_LEFT_OFF)
        figures = {**report.as_json(), **_of_body(item)}
        return {**line, "output": str(target), "memory_estimate": memory, "pieces": report.pieces, **figures}
    except Exception as error:  # any error, as other meshes follow
        return failure(line, error, explained(error))


def _of_body(item: FormItem) -> Line:
    """Return the counts of a body of several objects; vertices are numbered through them, in order of `objects`."""
    reports = [result.report for result in item.results]
    if len(reports) == 1:
        return {}
    starts = np.cumsum([0, *(each.vertices for each in reports)]).tolist()
    points = zip(*(each.feature_points for each in reports), strict=True)
    return {
        "objects": [reading.name for reading in item.readings],
        "vertices": starts[-1],
        "faces": sum(each.faces for each in reports),
        "feature_points": [
            next((start + own for start, own in zip(starts, each, strict=False) if own >= 0), -1) for each in points
        ],
        "patch_sizes": [sum(each) for each in zip(*(each.patch_sizes for each in reports), strict=True)],
    }


def _require_keys(task: FormTask) -> None:
    """Reject objects whose modifiers change the number of vertices if shape keys are requested."""
    if task.resized:
        raise CanonicalFormError(
            f"Modifiers change the number of vertices of {', '.join(task.resized)}, so that no shape key can hold the "
            "forms. Apply or remove them, or choose --frames-as files."
        )


def _in_axes(form: FloatArray, obj: bpy.types.Object, wanted: Wanted) -> FloatArray:
    """Transform a form from local space to the axes of the file, if these are given."""
    if wanted.axes is None:
        return form
    placed = np.array(obj.matrix_world)
    return np.asarray((form @ placed[:3, :3].T + placed[:3, 3]) @ wanted.axes)


def _head(line: Line) -> Line:
    """Return the part of a line that identifies its mesh."""
    return {name: line[name] for name in ("input", "object", "objects", "frame") if name in line}
