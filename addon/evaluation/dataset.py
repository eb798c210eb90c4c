"""Finds the shapes of a dataset and their classes."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

from ..core import InvalidMeshError

SUFFIXES = (".off", ".obj", ".ply", ".stl", ".glb", ".blend")


@dataclass(frozen=True)
class Shape:
    """One mesh file of a dataset.

    Attributes
    ----------
    label : str
        Its class.
    name : str
        Its name, unique in its class and valid as a file name.
    path : Path
        The file.
    """

    label: str
    name: str
    path: Path


def shapes_in(folder: Path, classes: Path | None = None) -> list[Shape]:
    """List the shapes of a dataset.

    Parameters
    ----------
    folder : Path
        Either one subfolder per class, or all meshes in one folder with a file that lists their classes.
    classes : Path, optional
        That file: a .cla file of the Princeton Shape Benchmark, as used by SHREC, or lines ``file,class``. If
        omitted, it is looked for in the folder.

    Returns
    -------
    list of Shape
        Sorted by class and name.

    Raises
    ------
    InvalidMeshError
        If there is no mesh, or the file of classes does not fit the meshes; the message names the remedy.
    """
    if not folder.is_dir():
        raise InvalidMeshError(f"{folder} is not a folder.")
    flat = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file())
    if classes is None and flat:
        found = sorted(path for path in folder.iterdir() if path.suffix.lower() == ".cla")
        if len(found) != 1:
            raise InvalidMeshError(
                f"{folder} holds meshes side by side. Name the file with their classes with --classes, or put each "
                "class in a folder of its own."
            )
        classes = found[0]
    if classes is not None:
        pairs = [(label, path) for path, label in _labelled(flat, classes).items()]
    else:
        pairs = [
            (inner.name, path)
            for inner in sorted(folder.iterdir())
            if inner.is_dir() and not inner.name.startswith(".")
            for path in sorted(inner.iterdir())
            if path.suffix.lower() in SUFFIXES and path.is_file()
        ]
    if not pairs:
        raise InvalidMeshError(f"{folder} holds no mesh ({', '.join(SUFFIXES)}), in it or in a folder a class in it.")
    shapes: dict[tuple[str, str], Shape] = {}
    meant: dict[str, str] = {}
    for label, _ in pairs:
        if meant.setdefault(_safe(label), label) != label:
            raise InvalidMeshError(
                f"The classes {meant[_safe(label)]!r} and {label!r} would have the same name in the tables. Rename one."
            )
    for label, path in sorted(pairs, key=lambda pair: (pair[0], pair[1].name)):
        label, name = _safe(label), _safe(path.stem)
        if (label, name) in shapes:
            name = _safe(path.name)
        if (label, name) in shapes:
            raise InvalidMeshError(f"{path} and {shapes[label, name].path} would have the same name in the tables.")
        shapes[label, name] = Shape(label, name, path)
    return list(shapes.values())


def _safe(name: str) -> str:
    """Replace characters that are not valid in file names on every system."""
    safe = re.sub(r"[^\w.+-]", "_", name).strip(".")
    return safe or "_"


def _labelled(paths: list[Path], classes: Path) -> dict[Path, str]:
    try:
        text = classes.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise InvalidMeshError(f"{classes} cannot be read ({error.strerror}).") from error
    if text.lstrip().upper().startswith("PSB"):
        return _by_number(paths, _read_cla(text, classes), classes)
    by_name = {path.name: path for path in paths} | {path.stem: path for path in paths}
    labelled = {}
    try:
        rows = list(csv.reader(text.splitlines()))
    except csv.Error as error:
        raise InvalidMeshError(f"{classes.name} is neither a .cla file nor lines 'file,class' ({error}).") from error
    for row in rows:
        if len(row) == 2 and row[0].strip() in by_name:
            labelled[by_name[row[0].strip()]] = row[1].strip()
        elif row and row != ["file", "class"]:
            raise InvalidMeshError(
                f"{classes.name}: {','.join(row)!r} does not name a mesh of the dataset and its class."
            )
    return labelled


def _read_cla(text: str, path: Path) -> dict[int, str]:
    """Read a .cla file: a header, and for each class its name, its parent, and the number and indices of its shapes."""
    words = text.split()
    label_of: dict[int, str] = {}
    try:
        count, at = int(words[2]), 4
        for _ in range(count):
            label, parent, members = words[at], words[at + 1], int(words[at + 2])
            whole = label if parent in ("0", "-1") else f"{parent}-{label}"
            for word in words[at + 3 : at + 3 + members]:
                label_of[int(re.sub(r"\D", "", word))] = whole
            at += 3 + members
    except (IndexError, ValueError) as error:
        raise InvalidMeshError(f"{path.name} is not a well-formed .cla file, or is cut short.") from error
    return label_of


def _by_number(paths: list[Path], label_of: dict[int, str], classes: Path) -> dict[Path, str]:
    """Assign shapes to files by the number in the file name: T17.off, m17.off, 17.off."""
    numbered: dict[int, Path] = {}
    for path in paths:
        number = re.search(r"(\d+)$", path.stem)
        if number:
            if int(number[1]) in numbered:
                raise InvalidMeshError(f"{path.name} and {numbered[int(number[1])].name} have the same number.")
            numbered[int(number[1])] = path
    missing = sorted(set(label_of) - set(numbered))
    if missing:
        raise InvalidMeshError(
            f"{classes.name} names {len(missing)} shapes that are not there, the first with number {missing[0]}."
        )
    return {numbered[number]: label for number, label in label_of.items()}
