"""Published benchmarks as they come: meshes, lists of pairs, and the vertices that correspond, in .vts files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

import numpy as np

from ...core import InvalidMeshError
from ...core.numerics.arrays import IntArray
from ..dataset import SUFFIXES

_TRUTH, _MIRRORED = ".vts", ".sym.vts"


@dataclass(frozen=True)
class Landmarked:
    """A mesh of a benchmark.

    Attributes
    ----------
    path : Path
        Its file.
    truth : (k,) ndarray of int
        The k vertices that correspond to those of every other mesh, in their order.
    mirrored : (k,) ndarray of int or None
        The vertices of the other side, left and right exchanged; None if the benchmark has none.
    """

    path: Path
    truth: IntArray
    mirrored: IntArray | None

    @property
    def name(self) -> str:
        """Its name in tables and lists of pairs."""
        return self.path.stem


def landmarked_meshes(folder: Path, truth: Path) -> list[Landmarked]:
    """List the meshes of a benchmark with their true correspondences.

    Parameters
    ----------
    folder : Path
        Folder of the meshes.
    truth : Path
        Folder of their .vts files: a number of a vertex a line, from 0 or from 1. Beside NAME.vts there may be
        NAME.sym.vts, with the vertices of the other side.

    Returns
    -------
    list of Landmarked
        Those that have a .vts file, by name.

    Raises
    ------
    InvalidMeshError
        If there are none, or a file does not hold such numbers.
    """
    paths = [path for path in sorted(folder.iterdir()) if path.suffix.lower() in SUFFIXES]
    files = {path: truth / f"{path.stem}{_TRUTH}" for path in paths}
    rows = {path: _numbers(file) for path, file in files.items() if file.is_file()}
    if not rows:
        raise InvalidMeshError(f"{truth} has no .vts file that is named after a mesh of {folder}.")
    first = 0 if any((each == 0).any() for each in rows.values()) else 1
    found = []
    for path, own in rows.items():
        other = truth / f"{path.stem}{_MIRRORED}"
        mirrored = _numbers(other) - first if other.is_file() else None
        found.append(Landmarked(path, own - first, mirrored if mirrored is None or len(mirrored) == len(own) else None))
    return found


def listed_pairs(meshes: Sequence[Landmarked], pairs: Path | None) -> list[tuple[Landmarked, Landmarked]]:
    """Return the pairs of a list, or all.

    Parameters
    ----------
    meshes : sequence of Landmarked
        The meshes.
    pairs : Path or None
        A file with two names a line; None for every mesh with every other.

    Returns
    -------
    list of (Landmarked, Landmarked)
        The mesh to match, and the mesh to match it with. Lines that name no mesh of the folder are left out, as lists
        are made for more than one selection.

    Raises
    ------
    InvalidMeshError
        If the file has no pair of these meshes.
    """
    if pairs is None:
        return list(permutations(meshes, 2))
    named = {name: each for each in meshes for name in (each.name, each.path.name)}
    lines = [line.replace(",", " ").split() for line in pairs.read_text(encoding="utf-8").splitlines()]
    found = [(named[line[0]], named[line[1]]) for line in lines if len(line) == 2 and {*line} <= named.keys()]
    if not found:
        raise InvalidMeshError(f"{pairs} names no pair of meshes of the folder.")
    return found


def _numbers(path: Path) -> IntArray:
    """Read whole numbers, one a line."""
    try:
        return np.array(path.read_text(encoding="utf-8").split(), dtype=np.int64)
    except ValueError as error:
        raise InvalidMeshError(f"{path} must hold the number of a vertex in each line.") from error
