"""The files that a run reads, and the names of its results."""

from __future__ import annotations

import glob
from collections import Counter
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

from ..blender.files.kinds_of_files import READ
from ..core.run.errors import CanonicalFormError


class InputFile(NamedTuple):
    """A file that a run reads.

    Attributes
    ----------
    path : Path
        The file.
    place : Path
        Its folder, relative to that which was named: where its results go in a tree.
    """

    path: Path
    place: Path = Path()


def found_files(words: Sequence[Path], output: Path, *, recursive: bool = False) -> list[InputFile]:
    """Return the files that the arguments stand for: folders for the meshes in them, patterns for matching files.

    Folders and patterns leave out files in the folder for results, `output`; `recursive`: include subfolders.
    """
    found: list[InputFile] = []
    for word in words:
        if word.is_dir():
            if word.resolve() == output.resolve():
                raise CanonicalFormError(f"{word} is the folder for the results. Choose another --output.")
            inside = _meshes(sorted(word.rglob("*") if recursive else word.iterdir()), output)
            if not inside:
                raise CanonicalFormError(f"The folder {word} holds no mesh ({', '.join(READ)}).")
            found += [InputFile(each, each.parent.relative_to(word)) for each in inside]
        elif not word.exists() and glob.has_magic(str(word)):
            fitting = _meshes(sorted(Path(each) for each in glob.glob(str(word), recursive=True)), output)  # noqa: PTH207 (may be absolute)
            if not fitting:
                raise CanonicalFormError(f"No mesh matches {word}.")
            plain = Path(*takewhile(lambda part: not glob.has_magic(part), word.parts))
            found += [InputFile(each, each.parent.relative_to(plain)) for each in fitting]
        else:
            found.append(InputFile(word))
    return found


def listed_files(file: Path) -> list[Path]:
    """Read the names of files from a list, one a line; relative ones count from the folder of the list."""
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise CanonicalFormError(
            f"The list {file} cannot be read. It is a text file with the name of a mesh a line."
        ) from error
    return [file.parent / line.strip() for line in lines if line.strip() and not line.startswith("#")]


def _meshes(paths: Sequence[Path], output: Path) -> list[Path]:
    """Keep the meshes that are not in the folder for results."""
    inside = output.resolve()
    return [each for each in paths if _is_mesh(each) and inside not in each.resolve().parents]


def _is_mesh(path: Path) -> bool:
    """Return whether a file is a mesh by its name; macOS writes a hidden ``._name`` beside files on other disks."""
    return path.suffix.lower() in READ and path.is_file() and not path.name.startswith(".")


def output_stems(paths: Sequence[Path]) -> list[str]:
    """Name each result after its file; if files in several folders have the same name, prefix the folder names.

    Files that differ by their ending only keep it.

    The names are unique on any file system, or an error names two files that would have the same.

    Examples
    --------
    >>> output_stems([Path("/a/rest.obj"), Path("/b/rest.obj"), Path("/b/walk.obj")])
    ['a-rest', 'b-rest', 'walk']
    """
    whole = [path.resolve() for path in paths]
    alike = Counter(str(path.with_suffix("")).casefold() for path in set(whole))
    names = [path.name if alike[str(own.with_suffix("")).casefold()] > 1 else path.stem
             for path, own in zip(paths, whole, strict=True)]  # fmt: skip
    last = list(names)
    for depth in range(1, max((len(path.parts) for path in whole), default=1)):
        count = Counter(name.casefold() for name in names)
        if max(count.values(), default=1) == 1:
            return names
        names = [
            "-".join([*path.parts[-1 - depth : -1], ending]) if count[name.casefold()] > 1 else name
            for path, name, ending in zip(whole, names, last, strict=True)
        ]
    first: dict[str, int] = {}
    for number, (path, name) in enumerate(zip(paths, names, strict=True)):
        other = first.setdefault(name.casefold(), number)
        if other != number:
            raise CanonicalFormError(
                f"The results of {paths[other]} and {path} would have the same name: the same mesh is named twice. "
                "Rename one, or compute them one after the other."
            )
    return names


def separators(stems: Sequence[str]) -> list[str]:
    """Choose separators between the names of files and of objects, so that no two results have the same name.

    Examples
    --------
    >>> separators(["cat", "cat-black", "dog"])
    ['--', '-', '-']
    """
    folded = sorted(stem.casefold() for stem in stems)
    found = []
    for stem in stems:
        dashes = "-"
        while any(each.startswith(stem.casefold() + dashes) for each in folded):
            dashes += "-"
        found.append(dashes)
    return found
