"""Which files a run reads, and what its results are called."""

from __future__ import annotations

import glob
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ..blender.files.kinds_of_files import READ
from ..core.run.errors import CanonicalFormError


def found_files(words: Sequence[Path], output: Path) -> list[Path]:
    """List the files that are meant: a folder means the meshes in it, a pattern those that fit.

    Parameters
    ----------
    words : sequence of Path
        Files, folders, and patterns that no file is called like.
    output : Path
        The folder for results; what lies there is not meant by a folder or pattern.

    Returns
    -------
    list of Path
        Files in the order of the words, those of a folder or pattern by name.

    Raises
    ------
    CanonicalFormError
        If a folder holds no mesh, or nothing fits a pattern.
    """
    found: list[Path] = []
    for word in words:
        if word.is_dir():
            inside = [each for each in sorted(word.iterdir()) if each.suffix.lower() in READ and each.is_file()]
            if word.resolve() == output.resolve():
                raise CanonicalFormError(f"{word} is the folder for the results. Choose another --output.")
            if not inside:
                raise CanonicalFormError(f"The folder {word} holds no mesh ({', '.join(READ)}).")
            found += inside
        elif not word.exists() and glob.has_magic(str(word)):
            fitting = sorted(Path(each) for each in glob.glob(str(word), recursive=True))  # noqa: PTH207 (may be absolute)
            fitting = [each for each in fitting if each.suffix.lower() in READ and each.is_file()]
            fitting = [each for each in fitting if output.resolve() not in each.resolve().parents]
            if not fitting:
                raise CanonicalFormError(f"No mesh is called like {word}.")
            found += fitting
        else:
            found.append(word)
    return found


def output_stems(paths: Sequence[Path]) -> list[str]:
    """Name each result after its file; files of one name in several folders get the folders' names in front.

    Parameters
    ----------
    paths : sequence of Path
        The files.

    Returns
    -------
    list of str
        Names without an ending, no two alike on any file system.

    Raises
    ------
    CanonicalFormError
        If a file is named twice, or two differ by their endings only; the sentence names both.

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
    """Choose what stands between the name of a file and that of an object in it, so that no two results are alike.

    Parameters
    ----------
    stems : sequence of str
        Names of the files' results.

    Returns
    -------
    list of str
        Dashes, more than one where another file's name goes on with one.

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
