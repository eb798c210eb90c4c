"""The work on one file, in a worker: open, compute, write, and say so in result lines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ..blender.files.kinds_of_files import PLAIN
from ..blender.jobs.likeness import Likeness
from ..core import CanonicalForm, CanonicalFormError
from ..core.method_api.costs import memory_estimate
from .claims import to_be_made
from .lines import DONE, Line, complain, failure, stage_line
from .open_files import Body, MeshInFile, OpenFile, Reference
from .opening import explained, open_file
from .targets import Targets
from .wanted import Wanted


def compute_file(targets: Targets, wanted: Wanted, reference: Reference) -> Iterator[list[Line]]:
    """Compute every mesh of a file, write the results, and yield the lines of each as soon as it is written."""
    try:
        for frames in wanted.frames_of_files:
            opened = open_file(targets.path, wanted, wanted.objects)  # again: without results of earlier frames
            for target, bodies in _planned(opened, targets, wanted, frames[0]):
                too_long = targets.too_long(target)
                if too_long:
                    error = CanonicalFormError(too_long)
                    yield [failure(_head(targets.path, body, frames[0]), error, too_long) for body in bodies]
                    continue
                with to_be_made(targets, target, frames, wanted) as skipped:
                    if skipped:
                        yield skipped
                    else:
                        found = [
                            _computed(_head(targets.path, body, frame), opened, body, wanted, reference)
                            for frame in frames
                            for body in bodies
                        ]
                        yield _written(found, opened, targets, target)
    except Exception as error:  # any error, as other files follow
        yield [failure({"input": str(targets.path)}, error, explained(error))]
    yield DONE


def compute_reference(path: Path, wanted: Wanted) -> CanonicalForm:
    """Compute the reference form that others are aligned to: that of the largest mesh, or of all together."""
    opened, meshes = _opened_reference(path, wanted)
    return opened.form(meshes if wanted.together else [_largest(meshes)])


def read_pose(path: Path, wanted: Wanted) -> Likeness:
    """Read the pose of the largest mesh of a file, to be applied to others."""
    opened, meshes = _opened_reference(path, wanted)
    return opened.pose(_largest(meshes))


def _opened_reference(path: Path, wanted: Wanted) -> tuple[OpenFile, list[MeshInFile]]:
    """Open a reference, which may have other names; its warnings are told at once, as it has no result line."""
    opened = open_file(path, wanted)
    for sentence in opened.warnings():
        complain(f"{path}: {sentence}")
    return opened, [mesh for mesh in opened.meshes if mesh.name in wanted.objects] or opened.meshes


def _largest(meshes: Sequence[MeshInFile]) -> MeshInFile:
    """Return the mesh with the most vertices."""
    return max(meshes, key=lambda mesh: mesh.vertices)


def _planned(
    opened: OpenFile, targets: Targets, wanted: Wanted, frame: int | None
) -> Iterator[tuple[Path, Sequence[Body]]]:
    """List the files to write, each with the bodies that it holds."""
    bodies: list[Body] = [opened.meshes] if wanted.together else [[mesh] for mesh in opened.meshes]
    numbered = None if wanted.frame_keys else frame
    if wanted.format == "blend" or len(bodies) == 1:
        yield targets.of_file(numbered), bodies
        return
    names = [mesh.name for mesh in opened.meshes]
    yield from zip(targets.of_objects(names, numbered), ([body] for body in bodies), strict=True)


def _head(path: Path, body: Body, frame: int | None) -> Line:
    """Return the part of a line that says what was computed."""
    line: Line = {"input": str(path), "object": body[0].name}
    if len(body) > 1:
        line["objects"] = [mesh.name for mesh in body]
    return line if frame is None else {**line, "frame": frame}


def _computed(head: Line, opened: OpenFile, body: Body, wanted: Wanted, reference: Reference) -> Line:
    """Compute one body and return its line."""
    try:
        if len(body) > 1 and f".{wanted.format}" in PLAIN:
            raise CanonicalFormError(
                f".{wanted.format} holds one object. With --together choose blend, glb, fbx or usdc."
            )
        memory = memory_estimate(sum(mesh.vertices for mesh in body), wanted.settings)
        name = f"{Path(head['input']).name} {head['object']} (about {memory:.1f} GB)"
        with stage_line(name, wanted.stages) as progress:
            report = opened.compute(body, head.get("frame"), reference, progress)
        figures = report.as_json()
        figures.pop("mends", None)  # of the panel
        return {**head, "memory_estimate": memory, **figures}
    except Exception as error:  # any error, as other meshes follow
        return failure(head, error, explained(error))


def _written(lines: list[Line], opened: OpenFile, targets: Targets, target: Path) -> list[Line]:
    """Write a file with the results of some lines, and return the lines."""
    if all("error" in line for line in lines):
        return lines
    try:
        targets.require_new(target)
        left_out = opened.write(target)
    except Exception as error:  # any error, as other files follow
        told = explained(error)
        return [line if "error" in line else failure(_mesh_of(line), error, told) for line in lines]
    warnings = [*left_out, *opened.warnings()]
    return [
        line if "error" in line else {**line, "output": str(target), "warnings": line["warnings"] + warnings}
        for line in lines
    ]


def _mesh_of(line: Line) -> Line:
    """Return the part of a line that says which mesh it is about."""
    return {name: line[name] for name in ("input", "object", "objects", "frame") if name in line}
