"""The command line: ``compute MESH… --output DIR``, the same for the bpy module and for Blender's ``--command``."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any, TextIO

import bpy

from .blender.advice import explained
from .blender.files import open_meshes, save_blend, save_form
from .blender.form_task import compute_on
from .blender.mesh_reading import refusal
from .blender.request import Request
from .core import CanonicalForm, CanonicalFormError, Settings
from .core.method_api.catalogue import methods
from .core.method_api.costs import memory_estimate
from .core.method_api.options import Option, options_of
from .core.method_api.settings import current_options, former_options
from .result_lines import claim_output


def main(arguments: list[str], output: TextIO | None = None, done: dict[str, Any] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : list of str
        The words after the name of the command.
    output : TextIO, optional
        Where the result lines go; standard output, claimed for them, when left out.
    done : dict, optional
        From `supervision.done_before`, in a process that is supervised: it is told there what this one is at.

    Returns
    -------
    int
        0 if every mesh was done, 1 if one failed, 2 if the words make no sense, 130 if stopped by the keyboard.
    """
    output = output or claim_output()
    try:
        with redirect_stdout(output):  # for --help
            options = _parser().parse_args(arguments)
        settings = _settings(options)
        names = _output_names(options.meshes)
        options.output.mkdir(parents=True, exist_ok=True)
    except SystemExit as stop:
        return int(stop.code or 0)
    except (CanonicalFormError, OSError) as error:
        print(f"canonical_form: {explained(error)}", file=sys.stderr)
        return 2
    failed = False
    first, written = (done["files"], set(done["written"])) if done else (0, set())

    def tell(**line: Any) -> None:
        print(json.dumps(line), file=output, flush=True)

    try:
        for number, (path, name) in enumerate(zip(options.meshes, names, strict=True), start=1):
            if number <= first:
                continue
            if done:
                tell(begun=str(path), number=number, folder=str(options.output))
            for line in _compute_file(path, name, settings, options, written):
                failed = failed or "error" in line
                tell(**line)
            if done:
                tell(ended=number)
    except KeyboardInterrupt:
        print("canonical_form: Interrupted; files written so far are complete.", file=sys.stderr)
        return 130
    if done:
        tell(finished=int(failed))
    return int(failed)


def _parser() -> argparse.ArgumentParser:
    default = Settings()
    parser = argparse.ArgumentParser(prog="canonical_form", description="Take the pose out of meshes.")
    compute = parser.add_subparsers(dest="command", required=True).add_parser(
        "compute", help="compute the canonical form of meshes", formatter_class=argparse.ArgumentDefaultsHelpFormatter
    )
    compute.add_argument("meshes", nargs="+", type=Path, metavar="MESH", help=".blend, .obj, .ply, .stl, .glb or .off")
    compute.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder for the results")
    compute.add_argument("--format", choices=("blend", "obj", "ply"), default="blend", help="what to write")
    compute.add_argument("--object", help="name of the one object of a file to compute (default: every mesh in it)")
    compute.add_argument("--value", type=float, default=1.0, help="value of the shape key in a .blend")
    for name, about in options_of(Settings).items():
        _add_option(compute, name, about, getattr(default, name))
    for name, value in former_options().items():
        told: dict[str, Any] = {"action": "store_true"} if isinstance(value, bool) else {"type": type(value)}
        compute.add_argument(_flag(name), default=argparse.SUPPRESS, help=argparse.SUPPRESS, **told)
    return parser


def _flag(name: str) -> str:
    """Spell an option as on the command line."""
    return "--" + name.replace("_", "-")


def _add_option(parser: argparse.ArgumentParser, name: str, about: Option, default: Any) -> None:
    """Offer an option of the method on the command line."""
    told: dict[str, Any] = {"default": default, "help": (about.help[0].lower() + about.help[1:]).replace("%", "%%")}
    if name == "method":
        told["choices"] = tuple(methods())
    elif about.choices:
        told["choices"] = tuple(choice.value for choice in about.choices)
    elif default is not None:
        told["type"] = type(default)
    parser.add_argument(_flag(name), **told)


def _settings(options: argparse.Namespace) -> Settings:
    words = vars(options)
    former = current_options({name: words[name] for name in former_options() if name in words})
    chosen = {name: words[name] for name in options_of(Settings)} | former
    if chosen["feature_points"]:
        try:
            chosen["feature_points"] = [int(word) for word in chosen["feature_points"].replace(",", " ").split()]
        except ValueError as error:
            raise CanonicalFormError(
                f"--feature-points must be whole numbers; got {options.feature_points}."
            ) from error
    return Settings(**{**chosen, "feature_points": chosen["feature_points"] or None})


def _output_names(paths: list[Path]) -> list[str]:
    """Name each result after its file; files of one name in several folders get the folders' names in front."""
    names = [path.stem for path in paths]
    for depth in range(1, max((len(path.resolve().parts) for path in paths), default=1)):
        count = Counter(name.casefold() for name in names)
        if max(count.values()) == 1:
            return names
        names = [
            "-".join(path.resolve().with_suffix("").parts[-1 - depth :]) if count[name.casefold()] > 1 else name
            for path, name in zip(paths, names, strict=True)
        ]
    if len({name.casefold() for name in names}) < len(names):
        raise CanonicalFormError("The same mesh is named twice, or two files differ by their ending only.")
    return names


def _compute_file(
    path: Path, name: str, settings: Settings, options: argparse.Namespace, written: set[str]
) -> Iterator[dict[str, Any]]:
    """Compute every mesh of a file and yield one line a mesh; `written` holds the names taken so far."""
    try:
        objects = open_meshes(path, options.object)
    except Exception as error:  # any: the files after it are still to be computed
        yield _failure({"input": str(path)}, error)
        return
    lines = []
    target = options.output / f"{name}.blend"
    for obj in objects:
        line: dict[str, Any] = {"input": str(path), "object": obj.name}
        try:
            reason = refusal(obj)
            if reason is not None:
                raise CanonicalFormError(reason)
            if obj.name in bpy.context.view_layer.objects:
                bpy.context.view_layer.objects.active = obj
            memory = memory_estimate(len(obj.data.vertices), settings)
            with _progress_line(f"{path.name} {obj.name} (about {memory:.1f} GB)") as progress:
                found, report = compute_on(obj, Request(settings, value=options.value, hausdorff=True), progress)
            if options.format != "blend" and isinstance(found, CanonicalForm):
                stem = name if len(objects) == 1 else f"{name}-{bpy.path.clean_name(obj.name)}"
                target = options.output / f"{_unused(stem, written)}.{options.format}"
                _require_new(target, options.meshes)
                save_form(target, found.vertices, obj.data)
                yield {
                    **line,
                    "output": str(target),
                    "memory_estimate": memory,
                    "pieces": report.pieces,
                    **report.as_json(),
                }
                continue
            lines.append(
                {**line, "output": str(target), "memory_estimate": memory, "pieces": report.pieces, **report.as_json()}
            )
        except Exception as error:  # any: the meshes after it are still to be computed
            lines.append(_failure(line, error))
    if options.format == "blend" and any("error" not in line for line in lines):
        try:
            _require_new(target, options.meshes)
            save_blend(target)
        except (CanonicalFormError, OSError, RuntimeError) as error:
            lines = [line if "error" in line else _failure(line, error) for line in lines]
    yield from lines


def _unused(stem: str, written: set[str]) -> str:
    """Append a number to a name that another mesh of this run has taken, on any file system."""
    name, number = stem, 1
    while name.casefold() in written:
        number += 1
        name = f"{stem}-{number}"
    written.add(name.casefold())
    return name


def _require_new(target: Path, inputs: list[Path]) -> None:
    """Refuse to write over any of the files that are read in this run, by whatever name."""
    for source in inputs if target.exists() else ():
        if source.exists() and target.samefile(source):
            raise CanonicalFormError(f"The result would overwrite an input, {source}. Choose another --output.")


def _failure(line: dict[str, Any], error: Exception) -> dict[str, Any]:
    """Tell on standard error, and make the line; what nobody foresaw is told as a mistake of ours."""
    sentence = explained(error).strip()
    if not isinstance(
        error, CanonicalFormError | OSError | RuntimeError | MemoryError
    ):  # RuntimeError: Blender itself refuses
        sentence = (
            f"This is a bug in Canonical Form; please report it with the file. {type(error).__name__}: {sentence}"
        )
    print(f"canonical_form: {line['input']}: {sentence}", file=sys.stderr)
    return {"input": line["input"], **({"object": line["object"]} if "object" in line else {}), "error": sentence}


@contextmanager
def _progress_line(name: str) -> Iterator[Any]:
    """Show one line of progress on a terminal, and nothing elsewhere."""
    if not sys.stderr.isatty():
        yield None
        return

    def show(done: float, stage: str) -> None:
        sys.stderr.write(f"\r{name}: {100 * done:3.0f} % {stage}\x1b[K")
        sys.stderr.flush()

    try:
        yield show
    finally:
        sys.stderr.write("\r\x1b[K")
