"""A file kept open in Blender: its objects, computed by the same job as that of the panel."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ..blender.files.face_indices import require_whole_faces
from ..blender.files.outside_references import pictures_not_held
from ..blender.files.reading_files import open_meshes, scripts_left_off
from ..blender.files.writing_files import Shown, save_blend, save_forms
from ..blender.jobs.form_item import FormItem
from ..blender.jobs.form_result import FormResult
from ..blender.jobs.form_task import FormTask
from ..blender.jobs.likeness import Likeness
from ..blender.jobs.pose_reading import read_likeness
from ..blender.jobs.request import Request
from ..blender.objects.mesh_reading import refusal
from ..blender.records.form_report import FormReport
from ..blender.results.bare_copies import bare_copies
from ..blender.results.frame_keys import keep_for_frame
from ..blender.results.kept_rigs import with_rigs
from ..blender.results.result_clearing import clear_from
from ..blender.results.result_writing import FIELD_COLOURS, PATCH_COLOURS
from ..core import CanonicalForm, CanonicalFormError
from ..core.numerics.arrays import FloatArray
from ..core.run.monitor import Progress
from .file_space import in_file_space, is_mirrored
from .lines import LEFT_OFF, pictures_told
from .open_files import Body, MeshInFile, Reference
from .wanted import Wanted

_SHARED = (
    "Objects that share their mesh with another took no part, and show its form: {}. "
    "Make them single user, or write another kind than .blend."
)


class BlenderFile:
    """The file that is open in Blender, of any kind that it reads; the methods are those of `OpenFile`.

    Objects that share a mesh count once if the mesh holds their result, or if their forms are equal.
    """

    def __init__(self, path: Path, wanted: Wanted, names: Sequence[str]) -> None:
        self._path, self._wanted = path, wanted
        self._frame: int | None = None
        self._item: FormItem | None = None  # the last one computed
        held = wanted.format == "blend" if wanted.together else not wanted.shown
        objects = open_meshes(
            path, names, shared=held, trusted=wanted.trusted, kept=wanted.format == "blend", shown=wanted.shown
        )
        require_whole_faces(objects)
        for obj in objects if wanted.together and not held else ():  # two eyes: each has a form of its own
            if obj.data.users > 1:
                obj.data = obj.data.copy()
        self.meshes = [MeshInFile(obj.name, len(obj.data.vertices), obj) for obj in objects]

    def compute(
        self, body: Body, frame: int | None, reference: Reference, progress: Progress | None = None
    ) -> FormReport:
        """Compute the body and write its result to the open file."""
        wanted, objects = self._wanted, self._objects(body, frame)
        for obj in objects if wanted.frame_keys and frame == wanted.frames[0] else ():
            clear_from(obj)  # a key per frame is not an update of one form
        task = FormTask(objects, self._request(reference))
        if (wanted.frame_keys or wanted.keep_rig) and task.resized:
            remedy = "choose --frames-as files" if wanted.frame_keys else "leave --keep-rig out"
            raise CanonicalFormError(
                f"Modifiers change the number of vertices of {', '.join(task.resized)}, so that no shape key can hold "
                f"the form. Apply or remove them, or {remedy}."
            )
        task.compute(progress)
        task.write()
        if task.errors:
            raise CanonicalFormError(" ".join(task.errors))
        (self._item,) = task.items
        if frame is not None and wanted.frame_keys:
            for name in self._item.written_to:
                keep_for_frame(bpy.data.objects[name], frame, wanted.frames)
        return _whole_report(self._item)

    def write(self, target: Path) -> list[str]:
        """Save the open file, or export the last result."""
        wanted, item = self._wanted, self._item
        if wanted.format == "blend":
            save_blend(target, wanted.mark)
            return []
        assert item is not None
        objects = [bpy.data.objects[name] for name in item.written_to]
        forms = [result.found.vertices for result in item.results]  # type: ignore[union-attr]
        read = [each.source for each in self.meshes]
        try:
            with ExitStack() as ready:
                rigs: list[bpy.types.Object] = []
                copies = objects
                if wanted.keep_rig:
                    rigs = ready.enter_context(with_rigs(objects, wanted.value, posed=wanted.shown))
                else:
                    copies = ready.enter_context(bare_copies(objects, forms))
                shown = [
                    _shown(copy, np.array(obj.matrix_world), result, wanted)
                    for copy, obj, result in zip(copies, objects, item.results, strict=True)
                ]
                pictures = None if wanted.trusted else self._path.parent
                left_out = save_forms(target, shown, wanted.mark, pictures=pictures, rigs=rigs)
                absent = [] if wanted.format in ("ply", "off") else pictures_not_held(copies, wanted.format)
        finally:
            bpy.data.batch_remove([each for each in objects if each not in read])
        return pictures_told(left_out, absent)

    def form(self, body: Body) -> CanonicalForm:
        """Compute the form of the body without writing it."""
        frame = self._wanted.frames[0] if self._wanted.frames else None
        task = FormTask(self._objects(body, frame), self._request(None))
        task.compute()
        item = task.items[0]
        if item.error is not None or item.whole_form is None:
            raise CanonicalFormError(item.error or f"{self._path.name} has no form.")
        return item.whole_form

    def pose(self, mesh: MeshInFile) -> Likeness:
        """Read the pose that the object is shown in."""
        _make_active(mesh.source)
        return read_likeness(mesh.source, self._wanted.side)

    def warnings(self) -> list[str]:
        """Say whether Blender left scripts or drivers off, and which objects have no form of their own."""
        own = [each.source for each in self.meshes]
        others = [obj.name for obj in bpy.data.objects if obj.users_scene and obj not in own
                  and any(obj.data == each.data for each in own)]  # fmt: skip
        told = [_SHARED.format(", ".join(others))] if self._wanted.together and others else []
        return told + ([LEFT_OFF] if scripts_left_off(self._path) else [])

    def _objects(self, body: Body, frame: int | None) -> list[bpy.types.Object]:
        """Return the objects of a body at a frame, the first of them active, if all of them can be used."""
        if frame is not None and frame != self._frame:
            bpy.context.scene.frame_set(frame)
            self._frame = frame
        objects = [each.source for each in body]
        _make_active(objects[0])
        for obj in objects:
            reason = refusal(obj)
            if reason is not None:
                raise CanonicalFormError(reason)
        return objects

    def _request(self, reference: Reference) -> Request:
        """Create the request: shown meshes get a new object, as their number of vertices may differ."""
        wanted = self._wanted
        form = None if isinstance(reference, Likeness) else reference
        return Request(
            wanted.settings,
            value=wanted.value,
            deformed=wanted.shown,
            new_object=wanted.shown and wanted.format != "blend" and not wanted.keep_rig,
            hausdorff="hausdorff" in wanted.measures,
            objects="TOGETHER" if wanted.together else "EACH",
            reference=None if form is None else lambda _cancelled: form,
            likeness=reference if isinstance(reference, Likeness) else None,
        )


def _make_active(obj: bpy.types.Object) -> None:
    """Make an object the active one, as it may be in Edit Mode; several objects may be, as the file was saved."""
    if obj.name in bpy.context.view_layer.objects:
        bpy.context.view_layer.objects.active = obj


def _whole_report(item: FormItem) -> FormReport:
    """Return the report on a body; the vertices of several objects are numbered through them."""
    reports = [result.report for result in item.results]
    if len(reports) == 1:
        return reports[0]
    starts = np.cumsum([0, *(each.vertices for each in reports)]).tolist()
    points = zip(*(each.feature_points for each in reports), strict=True)
    return replace(
        reports[0],
        vertices=starts[-1],
        faces=sum(each.faces for each in reports),
        feature_points=[
            next((start + own for start, own in zip(starts, each, strict=False) if own >= 0), -1) for each in points
        ],
        patch_sizes=[sum(each) for each in zip(*(each.patch_sizes for each in reports), strict=True)],
    )


def _shown(obj: bpy.types.Object, placement: FloatArray, result: FormResult, wanted: Wanted) -> Shown:
    """Return what is written of an object."""
    unit = bpy.context.scene.unit_settings
    return Shown(
        obj,
        in_file_space(result.found.vertices, placement, wanted, unit.scale_length),  # type: ignore[union-attr]
        result.found.patches if wanted.colours == "patches" else None,
        result.colours.named(wanted.colours),
        FIELD_COLOURS if wanted.colours == "adf" else PATCH_COLOURS,
        is_mirrored(placement, wanted),
    )
