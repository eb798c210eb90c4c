"""What the options of the command line ask for."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from ..blender.files.kinds_of_files import EXPORTERS, PLAIN
from ..core.method_api.options import options_of
from ..core.method_api.settings import Settings
from ..core.numerics.arrays import FloatArray
from ..core.run.errors import CanonicalFormError
from ..core.symmetry.limb_names import names_in
from .wanted import RESTS, Wanted


def wanted_of(options: argparse.Namespace, mark: str, *, stages: bool) -> Wanted:
    """Interpret the options."""
    frames = _frames(options.frames) if options.frames else () if options.frame is None else (options.frame,)
    frame_keys = options.frames_as == "keys"
    if frame_keys and (not options.frames or options.format != "blend"):
        raise CanonicalFormError("--frames-as keys needs --frames, and --format blend.")
    itself = options.command in ("transfer", "rig")
    if itself and (options.mesh == "shown" or frames or options.together or options.keep_rig):
        raise CanonicalFormError(
            f"{options.command} works on the mesh itself and keeps the rig: leave out --mesh shown, --frame, --frames, "
            "--together and --keep-rig."
        )
    if options.command == "rig" and f".{options.format}" in PLAIN:
        raise CanonicalFormError(f".{options.format} holds no armature. Choose blend, glb, fbx or usdc.")
    if options.command == "rig" and options.rigify and (options.reference or options.names != "rigify"):
        raise CanonicalFormError("--rigify makes Rigify's own bones: leave out --reference and --names.")
    if options.axes is not None and options.space == "object":
        raise CanonicalFormError("--axes turns the scene: it goes with --space world.")
    if options.units is not None and f".{options.format}" not in PLAIN:
        raise CanonicalFormError(f"--units is for .obj, .ply and .off; .{options.format} has a unit of its own.")
    if options.keep_rig and options.format not in EXPORTERS:
        raise CanonicalFormError(f"--keep-rig is for {', '.join(EXPORTERS)}; a .blend keeps the rig anyway.")
    if not 0.0 <= options.value <= 1.0:
        raise CanonicalFormError(f"--value must lie between 0 and 1; got {options.value:g}.")
    return Wanted(
        output=options.output,
        format=options.format,
        settings=_settings(options),
        shown=options.mesh == "shown" or bool(frames),
        frames=frames,
        frame_keys=frame_keys,
        objects=tuple(options.objects or ()),
        together=options.together,
        axes=None if options.axes is None else _axes(options.axes, options.format),
        space=options.space,
        units=options.units,
        keep_rig=options.keep_rig,
        colours=options.colours,
        measures=tuple(options.measure or ()),
        value=options.value,
        skip_existing=options.skip_existing,
        trusted=options.trust_scripts,
        pose=(options.pose or "").upper(),
        side=options.side,
        anyway=getattr(options, "anyway", False),
        kinds=tuple(getattr(options, "kinds", ())),
        rest=RESTS[getattr(options, "rest", "none")],
        rigify=getattr(options, "rigify", False),
        naming=getattr(options, "names", "rigify").upper(),
        mark=mark,
        stages=stages,
    )


def _settings(options: argparse.Namespace) -> Settings:
    """Create settings from the options of the method."""
    words = vars(options)
    chosen = {name: words[name] for name in options_of(Settings)}
    if chosen["feature_points"]:
        try:
            chosen["feature_points"] = [int(word) for word in chosen["feature_points"].replace(",", " ").split()]
        except ValueError as error:
            raise CanonicalFormError(
                f"--feature-points must be whole numbers; got {options.feature_points}."
            ) from error
    chosen |= {name: _vertices(name, words[name]) for name in ("part_here", "keep_joined")}
    chosen["feature_names"] = names_in(chosen["feature_names"] or "")
    return Settings(**{**chosen, "feature_points": chosen["feature_points"] or None})


def _vertices(name: str, path: Path | None) -> list[int] | None:
    """Read numbers of vertices from a text file."""
    if path is None:
        return None
    flag = "--" + name.replace("_", "-")
    try:
        numbers = [int(word) for word in path.read_text(encoding="utf-8").replace(",", " ").split()]
    except OSError as error:
        raise CanonicalFormError(f"{flag} {path} cannot be read: {error.strerror or error}.") from error
    except ValueError as error:
        raise CanonicalFormError(f"{flag} {path} must have whole numbers only.") from error
    if not numbers:
        raise CanonicalFormError(f"{flag} {path} has no numbers.")
    return numbers


def _axes(text: str, kind: str) -> FloatArray:
    """Return the rotation to axes given as UP,FACING."""
    if f".{kind}" not in PLAIN:
        raise CanonicalFormError(f"--axes is for .obj, .ply and .off; .{kind} has axes of its own.")
    named = {
        sign + letter: direction * np.eye(3)[place]
        for sign, direction in (("", 1.0), ("+", 1.0), ("-", -1.0))
        for place, letter in enumerate("XYZ")
    }
    words = text.upper().split(",")
    if len(words) != 2 or any(word not in named for word in words) or words[0][-1] == words[1][-1]:
        raise CanonicalFormError(f"--axes must be two different axes, as Z,-Y; got {text}.")
    up, facing = named[words[0]], named[words[1]]
    return np.array([np.cross(up, facing), -facing, up])  # images of X, Y and Z of the scene


def _frames(text: str) -> tuple[int, ...]:
    """Return the frames of A:B or A:B:STEP."""
    try:
        numbers = [int(word) for word in text.split(":")]
        first, last, step = (*numbers, 1)[:3]
        frames = tuple(range(first, last + 1, step))
    except ValueError as error:
        raise CanonicalFormError(f"--frames must be A:B or A:B:STEP, whole numbers; got {text}.") from error
    if not frames or len(numbers) not in (2, 3) or step < 1:
        raise CanonicalFormError(f"--frames must name at least one frame, A:B or A:B:STEP with A up to B; got {text}.")
    return frames
