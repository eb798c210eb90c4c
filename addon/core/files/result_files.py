"""Saves what doors return as .npz files, without pickling, and loads it again."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ..run.errors import InvalidFileError
from ..run.messages import Message

FORMAT = 1  # of the files; raised when a version can no longer read older ones
_ENTRY = "canonical_form"  # the entry with everything but arrays
_KINDS = {  # what a file may hold, and where it is defined: a stranger's file names nothing else
    "CanonicalForm": "results",
    "FeaturePatches": "results",
    "Match": "results",
    "MatchedSeams": "results",
    "PosedLike": "results",
    "Rigged": "results",
    "Stance": "results",
    "Skeleton": "rigging.skeleton",
    "BoneMotions": "rigging.skeleton",
    "BodyLimbs": "symmetry.limbs",
    "Limbs": "symmetry.limbs",
    "SeamSides": "matching.seam_sides",
    "CutSurface": "matching.seam_sides",
    "Parted": "fused.on_given",
    "PartedMesh": "fused.parting",
}
_RESULTS = ("CanonicalForm", "FeaturePatches", "Match", "PosedLike", "Rigged", "Stance")
_DEEPEST = 40  # level of nesting; results have ten


def save(path: str | os.PathLike[str], result: Any) -> Path:
    """Save a result of this package as an .npz file.

    Its arrays can be read without this package, too: every array of the result is an entry named after it, such as
    ``vertices``; the entry ``canonical_form`` is JSON with everything else.

    Parameters
    ----------
    path : str or path-like
        The file; the ending .npz is added if it is missing. It is written beside, then renamed.
    result : CanonicalForm, FeaturePatches, Match, PosedLike, Rigged or Stance
        What a door has returned.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InvalidFileError
        If it is none of these.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from addon.core import canonical_form
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> form = canonical_form(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> path = save(Path(tempfile.mkdtemp()) / "form", form)
    >>> path.name, bool((load(path).vertices == form.vertices).all())
    ('form.npz', True)
    """
    if type(result).__name__ not in _RESULTS:
        raise InvalidFileError("file_kind", type=type(result).__name__, kinds=", ".join(_RESULTS))
    arrays: dict[str, np.ndarray] = {}
    stored = {"format": FORMAT, "result": _stored(result, "", arrays)}
    target = Path(path)
    target = target if target.suffix == ".npz" else target.with_name(target.name + ".npz")
    beside = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        with beside.open("wb") as file:
            np.savez_compressed(file, **{_ENTRY: np.array(json.dumps(stored))}, **arrays)  # type: ignore[arg-type]
        beside.replace(target)
    finally:
        beside.unlink(missing_ok=True)
    return target


def load(path: str | os.PathLike[str]) -> Any:
    """Load a result that `save` has written.

    Nothing in the file is run: it may be from a stranger.

    Parameters
    ----------
    path : str or path-like
        The file.

    Returns
    -------
    CanonicalForm, FeaturePatches, Match, PosedLike, Rigged or Stance
        The result, equal to the one that was saved.

    Raises
    ------
    InvalidFileError
        If it is not such a file, or is damaged, or of a later version.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from addon.core import match
    >>> tetrahedron, faces = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> found = match(tetrahedron, faces, tetrahedron, faces)
    >>> again = load(save(Path(tempfile.mkdtemp()) / "match.npz", found))
    >>> bool((again.vertices == found.vertices).all()), again.sides == found.sides
    (True, True)
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            stored = json.loads(str(file[_ENTRY]))
            if not isinstance(stored, dict) or stored.get("format", 0) > FORMAT:
                raise InvalidFileError("file_later")
            arrays = {name: file[name] for name in file.files if name != _ENTRY}
        found = _restored(stored["result"], arrays)
    except (BadZipFile, EOFError, KeyError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise InvalidFileError("file_damaged", name=os.fspath(path)) from error
    if type(found).__name__ not in _RESULTS:
        raise InvalidFileError("file_damaged", name=os.fspath(path))
    return found


def _stored(value: Any, name: str, arrays: dict[str, np.ndarray]) -> Any:
    """Turn a value into JSON, with its arrays set aside by name."""
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Message):
        numbers = _stored(value.numbers, name, arrays)
        return {"message": str(value), "kind": value.kind, "numbers": numbers, "sentence": value.sentence}
    known = type(value).__name__
    if known in _KINDS:
        return {
            "class": known,
            "values": {key: _stored(each, _below(name, key), arrays) for key, each in _parts(value)},
        }
    if isinstance(value, Mapping):
        return {"mapping": [[str(key), _stored(each, _below(name, key), arrays)] for key, each in value.items()]}
    if isinstance(value, list | tuple):
        inside = [_stored(each, _below(name, number), arrays) for number, each in enumerate(value)]
        return inside if isinstance(value, list) else {"tuple": inside}
    if value is None or isinstance(value, str | bool | int | float):
        return value
    raise InvalidFileError("file_kind", type=known, kinds=", ".join(_KINDS))


def _below(name: str, part: object) -> str:
    """Name a part of a value."""
    return f"{name}.{part}" if name else str(part)


def _parts(value: Any) -> list[tuple[str, Any]]:
    """List the fields of a dataclass or a named tuple."""
    names = [each.name for each in fields(value)] if is_dataclass(value) else value._fields
    return [(name, getattr(value, name)) for name in names]


def _restored(stored: Any, arrays: Mapping[str, np.ndarray], depth: int = 0) -> Any:
    """Turn JSON back into a value."""
    if depth > _DEEPEST:
        raise ValueError("nested too deeply")
    if isinstance(stored, list):
        return [_restored(each, arrays, depth + 1) for each in stored]
    if not isinstance(stored, dict):
        return stored
    if "array" in stored:
        return arrays[stored["array"]]
    if "message" in stored:
        numbers = _restored(stored["numbers"], arrays, depth + 1)
        return Message(stored["message"], stored["kind"], numbers, stored["sentence"])
    if "mapping" in stored:
        return {key: _restored(each, arrays, depth + 1) for key, each in stored["mapping"]}
    if "tuple" in stored:
        return tuple(_restored(each, arrays, depth + 1) for each in stored["tuple"])
    module = import_module(f"..{_KINDS[stored['class']]}", __package__)
    values = {key: _restored(each, arrays, depth + 1) for key, each in stored["values"].items()}
    return getattr(module, stored["class"])(**values)
