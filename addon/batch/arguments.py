"""The arguments of the command line, their help, and what they mean."""

from __future__ import annotations

import argparse
import tomllib
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..blender.files.kinds_of_files import READ, WRITTEN
from ..blender.files.plain_files import has_blender
from ..core.method_api.catalogue import methods
from ..core.method_api.options import Option, options_of
from ..core.method_api.settings import Settings
from ..core.rigging.namings import NAMINGS
from .file_space import UNITS
from .wanted import KINDS, RESTS

_POSING = """\
examples:
  pose-like scans --output posed --pose t             every scan of a folder in a T-pose
  pose-like scan.ply --output posed --reference mannequin.blend
                                                      as another mesh stands
  pose-like scan.glb --output posed --reference mannequin.glb --side 1
                                                      left and right, or front and back, the other way round
"""
_TRANSFERRING = """\
examples:
  transfer scan.ply --output rigged --reference base.blend --format glb
                                                      the rig of a base mesh on a scan
  transfer lods --output done --reference hero.glb --kinds uvs materials keys
"""
_RIGGING = """\
examples:
  rig scan.ply --output rigged                        an armature with weights, and the scan in a T-pose
  rig scans --output rigged --format glb --rest none  every scan of a folder, as it stands, for other programs
  rig scan.ply --output rigged --rigify               with Rigify's controls
  rig scan.ply --output rigged --reference hero.glb   with the bones of another character
"""
_MATCHING = """\
examples:
  match scan.ply base.glb --output matches            for every vertex of the first the point on the second
"""
_MARKS = {
    "part_here": "a text file of vertices, numbered from 0, such as those of edges, two a line: the mesh is parted "
    "between them, as at the vertex group Part Here of a .blend",
    "keep_joined": "the same for vertices at which only what is marked is parted, as at the group Keep Joined",
}
_EPILOGUE = """\
examples:
  compute scans --output forms                        every mesh of a folder
  compute "scans/*.glb" --output forms --format glb   those that fit a pattern
  compute poses --output forms --reference first --format obj
                                                      all turned and numbered like the first
  compute fox.glb --output forms --frames 1:40:4      ten frames of an animation
  compute scans --output forms --jobs 4 --skip-existing
                                                      what is missing, four at once

Standard output has one line of JSON a result; docs/scripting.md lists its fields. Exit codes: 0 all done, 1 at least
one mesh failed, 2 the words make no sense, 130 stopped by Ctrl+C.
"""


def parsed(words: list[str]) -> argparse.Namespace:
    """Parse the arguments of the command line."""
    return _parser().parse_args(words)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="canonical-form",
        description="Take the pose out of meshes, or change it.",
        epilog="evaluate and evaluate-matches compare methods on a dataset; each has a --help of its own.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and end")
    commands = parser.add_subparsers(dest="command", required=True)
    compute = commands.add_parser(
        "compute", help="compute the canonical form of meshes", epilog=_EPILOGUE, formatter_class=_Help
    )
    _add_files(compute)
    how = compute.add_argument_group("orientation of the form")
    how.add_argument(
        "--reference", metavar="FILE", help="align all forms to that of this mesh and use its limb numbers; \"first\" "
        "selects the first mesh",
    )  # fmt: skip
    _add_axes(how)
    _add_method(compute, how)
    compute.set_defaults(pose=None, side=-1)
    posing = commands.add_parser(
        "pose-like",
        help="put meshes into the pose of another, or of a mannequin",
        epilog=_POSING,
        formatter_class=_Help,
    )
    _add_files(posing)
    how = posing.add_argument_group("the pose")
    whose = how.add_mutually_exclusive_group(required=True)
    whose.add_argument(
        "--reference", metavar="FILE", help="take the pose of the mesh in this file, which has a similar body"
    )
    whose.add_argument("--pose", choices=("t", "a"), help="that of a mannequin: a T-pose or an A-pose")
    _add_side(how)
    _add_axes(how)
    _add_method(posing, how)
    transferring = commands.add_parser(
        "transfer",
        help="take weights, UV maps, colours, shape keys or materials over from another mesh",
        epilog=_TRANSFERRING,
        formatter_class=_Help,
    )
    _add_files(transferring)
    how = transferring.add_argument_group("the transfer")
    how.add_argument(
        "--reference", metavar="FILE", required=True, help="take them from the largest mesh in this file, and "
        "from the others that its armature moves",
    )  # fmt: skip
    how.add_argument("--kinds", nargs="+", choices=tuple(KINDS), default=["weights"], help="what is taken over")
    _add_side(how)
    _add_axes(how)
    _add_method(transferring, how)
    transferring.set_defaults(pose=None)
    rigging = commands.add_parser(
        "rig", help="give meshes in any pose an armature with weights", epilog=_RIGGING, formatter_class=_Help
    )
    _add_files(rigging)
    how = rigging.add_argument_group("the rig")
    how.add_argument(
        "--reference", metavar="FILE", help="take the bones of the rigged character in this file, which has a similar "
        "body, instead of the mannequin's",
    )  # fmt: skip
    how.add_argument(
        "--rest", choices=tuple(RESTS), default="t", help="the pose at rest: a T-pose, an A-pose, that of the "
        "reference, or none: as the mesh stands",
    )  # fmt: skip
    how.add_argument(
        "--names", choices=[each.lower() for each in NAMINGS], default="rigify", help="how bones are called"
    )
    how.add_argument("--rigify", action="store_true", help="generate Rigify's rig on the bones of the mannequin")
    _add_side(how)
    _add_axes(how)
    _add_method(rigging, how)
    rigging.set_defaults(pose=None)
    matching = commands.add_parser(
        "match", help="find the corresponding point on another mesh for every vertex", epilog=_MATCHING,
        formatter_class=_Help,
    )  # fmt: skip
    matching.add_argument("meshes", nargs=2, type=Path, metavar="FILE", help="files of similar bodies, one mesh each")
    matching.add_argument(
        "--output", type=Path, required=True, metavar="DIR", help="folder for the result, an .npz file"
    )
    matching.add_argument(
        "--objects", "--object", nargs="+", metavar="NAME", help="objects to match (default: the largest)"
    )
    _add_trust(matching)
    _add_side(matching)
    _add_method(matching, None)
    matching.set_defaults(
        format="npz", mesh="base", frame=None, frames=None, frames_as="files", together=False, axes=None, value=1.0,
        space="world", units=None, keep_rig=False, colours="none", measure=None, dry_run=False, log=None, timeout=None,
        skip_existing=False, pose=None, jobs=1, scheduler=None,
    )  # fmt: skip
    return parser


class _Version(argparse.Action):
    """Prints the version: that of the manifest beside this package, or of the installed package."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Print it and end."""
        manifest = Path(__file__).parents[2] / "blender_manifest.toml"
        if manifest.is_file():
            number = tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]
        else:
            number = version("canonical-form")
        print(f"canonical-form {number}")
        parser.exit()


def _add_files(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for input and output files."""
    files = parser.add_argument_group("files")
    files.add_argument(
        "meshes", nargs="*", type=Path, metavar="MESH", help=f"files, folders or patterns ({', '.join(READ)})"
    )
    files.add_argument("--files-from", type=Path, metavar="LIST", help="a text file with more of them, one a line")
    files.add_argument("--recursive", action="store_true", help="take the subfolders of folders as well")
    files.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder for the results")
    files.add_argument(
        "--format", choices=WRITTEN, default="blend" if has_blender() else "obj",
        help="what to write (default: blend, obj without Blender)",
    )  # fmt: skip
    files.add_argument(
        "--output-tree", action="store_true", help="results in folders as those of their files, with the "
        "whole names of these: what else is computed has no say in a name",
    )  # fmt: skip
    files.add_argument(
        "--dry-run", action="store_true", help="only list the files and the results that they would have"
    )
    files.add_argument(
        "--skip-existing", action="store_true", help="skip files that already have their result, or that another run "
        "is working on",
    )  # fmt: skip
    files.add_argument(
        "--log", type=Path, metavar="FILE", help="a file for the lines, too; with --skip-existing it is continued, "
        "and has each result once",
    )  # fmt: skip
    files.add_argument("--timeout", type=float, metavar="SECONDS", help="give a file up that takes longer")
    files.add_argument(
        "--keep-rig", action="store_true", help="in .glb, .fbx and .usd: armature, weights and shape keys, the result "
        "as one of these",
    )  # fmt: skip
    files.add_argument(
        "--colours", choices=("none", "patches", "adf"), default="none", help="what colours show in other kinds than "
        ".blend: only what the mesh has, its patches (in .obj also groups), or the Auto Diffusion Function",
    )  # fmt: skip
    files.add_argument(
        "--measure", nargs="+", choices=("hausdorff",), metavar="NAME", help="measures that take longer than the form, "
        "to be reported as well: hausdorff, the distance from the pose",
    )  # fmt: skip
    files.add_argument("--jobs", type=int, default=1, metavar="N", help="number of files processed at once")
    files.add_argument("--scheduler", metavar="HOST:PORT", help="use the Dask cluster of this scheduler instead")
    what = parser.add_argument_group("what is read")
    what.add_argument(
        "--mesh", choices=("base", "shown"), default="base",
        help="base: the mesh itself; shown: as modifiers, armature and shape keys show it",
    )  # fmt: skip
    when = what.add_mutually_exclusive_group()
    when.add_argument("--frame", type=int, metavar="N", help="take the mesh as shown at this frame")
    when.add_argument("--frames", metavar="A:B[:STEP]", help="a result for each of these frames, B included")
    what.add_argument(
        "--frames-as", choices=("files", "keys"), default="files",
        help="results of frames are numbered files, or shape keys of one .blend, each keyed to show at its frame",
    )  # fmt: skip
    what.add_argument("--objects", "--object", nargs="+", metavar="NAME", help="objects to compute (default: all)")
    what.add_argument("--together", action="store_true", help="all objects of a file are one body, in one result")
    _add_trust(what)


def _add_trust(group: argparse._ArgumentGroup | argparse.ArgumentParser) -> None:
    """Add the option to trust the files."""
    group.add_argument(
        "--trust-scripts", action="store_true", help="the files are your own: run scripts and Python drivers in .blend "
        "files, and include files that they refer to outside their folders",
    )  # fmt: skip


def _add_axes(group: argparse._ArgumentGroup) -> None:
    """Add the options for the placement of results in files."""
    group.add_argument(
        "--axes", metavar="UP,FACING", help="axes of .obj, .ply and .off files: which way is up and which way upright "
        "bodies face (default: Y,Z for .obj, as most programs have it, and Z,-Y, as in Blender, for .ply and .off)",
    )  # fmt: skip
    group.add_argument(
        "--space", choices=("world", "object"), default="world", help="whether .obj, .ply and .off files hold the mesh "
        "as it lies in the scene, or in its own space",
    )  # fmt: skip
    group.add_argument(
        "--units", choices=tuple(UNITS), help="unit of length of .obj, .ply and .off files (default: that of the scene)"
    )
    group.add_argument("--value", type=float, default=1.0, help="value of the shape key in a .blend, 0 to 1")


def _add_side(group: argparse._ArgumentGroup | argparse.ArgumentParser) -> None:
    """Add the options for the way to match, and for what is unlikely to be right."""
    group.add_argument(
        "--side", type=int, default=-1, metavar="N",
        help="which way to match left and right, front and back: -1 for the likeliest, or its number from 0",
    )  # fmt: skip
    group.add_argument("--anyway", action="store_true", help="write what is unlikely to be right, too")


def _add_method(parser: argparse.ArgumentParser, placing: argparse._ArgumentGroup | None) -> None:
    """Add the options of the method; if forms are placed, the orientation goes to the group for placement."""
    default = Settings()
    method = parser.add_argument_group("the method (lengths in units of the root of the area)")
    for name, words in _MARKS.items():
        method.add_argument(_flag(name), type=Path, metavar="FILE", help=words)
    for name, about in options_of(Settings).items():
        group = placing if name == "orientation" and placing is not None else method
        _add_option(group, name, about, getattr(default, name))


class _Help(argparse.ArgumentDefaultsHelpFormatter, argparse.RawDescriptionHelpFormatter):
    """Shows default values if there are any, and keeps the line breaks of the examples."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        if action.default in (None, False):
            return action.help
        return super()._get_help_string(action)


def _flag(name: str) -> str:
    """Return the name of an option on the command line."""
    return "--" + name.replace("_", "-")


def _add_option(parser: argparse._ArgumentGroup, name: str, about: Option, default: Any) -> None:
    """Add an option of the method to the command line."""
    told: dict[str, Any] = {"default": default, "help": (about.help[0].lower() + about.help[1:]).replace("%", "%%")}
    if name == "method":
        told["choices"] = tuple(methods())
    elif about.choices:
        told["choices"] = tuple(choice.value for choice in about.choices)
    elif default is not None:
        told["type"] = type(default)
    parser.add_argument(_flag(name), **told)
