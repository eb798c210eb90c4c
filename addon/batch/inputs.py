"""The files that a run reads, and the names of its results."""

from __future__ import annotations

import glob
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ..blender.files.kinds_of_files import READ
from ..core.run.errors import CanonicalFormError


def found_files(words: Sequence[Path], output: Path) -> list[Path]:
    """Return the files that the arguments stand for: folders for the meshes in them, patterns for matching files.

    Folders and patterns leave out files in the folder for results, `output`.
    """
    found: list[Path] = []
    for word in words:
        if word.is_dir():
            inside = [each for each in sorted(word.iterdir()) if _is_mesh(each)]
            if word.resolve() == output.resolve():
                raise CanonicalFormError(f"{word} is the folder for the results. Choose another --output.")
            if not inside:
                raise CanonicalFormError(f"The folder {word} holds no mesh ({', '.join(READ)}).")
            found += inside
        elif not word.exists() and glob.has_magic(str(word)):
            fitting = sorted(Path(each) for each in glob.glob(str(word), recursive=True))  # noqa: PTH207 (may be absolute)
            fitting = [each for each in fitting if _is_mesh(each) and output.resolve() not in each.resolve().parents]
            if not fitting:
                raise CanonicalFormError(f"No mesh matches {word}.")
            found += fitting
        else:
            found.append(word)
    return found


def _is_mesh(path: Path) -> bool:
    """Return whether a file is a mesh by its name; macOS writes a hidden ``._name`` beside files on other disks."""
    return path.suffix.lower() in READ and path.is_file() and not path.name.startswith(".")


def output_stems(paths: Sequence[Path]) -> list[str]:
    """Name each result after its file; if files in several folders have the same name, prefix the folder names.

    The names are unique on any file system, or an error names two files that would have the same.

    Examples
    --------
    >>> output_stems([Path("/a/rest.obj"), Path("/b/rest.obj"), Path("/b/walk.obj")])
    ['a-rest', 'b-rest', 'walk']
    """
    whole = [path.resolve() for path in paths]
    names = [path.stem for path in paths]
    for depth in range(1, max((len(path.parts) for path in whole), default=1)):
        count = Counter(name.casefold() for name in names)
        if max(count.values(), default=1) == 1:
            return names
        names = [
            "-".join(path.with_suffix("").parts[-1 - depth :]) if count[name.casefold()] > 1 else name
            for path, name in zip(whole, names, strict=True)
        ]
    first: dict[str, int] = {}
    for number, (path, name) in enumerate(zip(paths, names, strict=True)):
        other = first.setdefault(name.casefold(), number)
        if other != number:
            raise CanonicalFormError(
                f"The results of {paths[other]} and {path} would have the same name: the same mesh is named twice, or "
                "two files differ by their ending only. Rename one, or compute them one after the other."
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
