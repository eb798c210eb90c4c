"""Stores each result on disk in a separate file that is never partial, so that a run can be resumed."""

from __future__ import annotations

import hashlib
import json
import os
import time
import zipfile
import zlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from .dataset import Shape
from .methods import Method
from .work import Outcome

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BROKEN = (OSError, ValueError, KeyError, EOFError, TypeError, zipfile.BadZipFile, zlib.error)  # of a truncated file
_DOTS = 110  # per inch, in images
_STALE = 3600.0  # seconds after which a partial file belongs to no running process


class Store:
    """The results of one evaluation.

    Parameters
    ----------
    folder : Path
        The output folder; results are in its subfolder ``results``.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._results = folder / "results"
        self._results.mkdir(parents=True, exist_ok=True)
        self._keys: dict[tuple[Shape, str], str] = {}
        for partial in [*folder.glob(".*.partial"), *self._results.rglob(".*.partial")]:  # of runs that were killed
            with suppress(OSError):
                if time.time() - partial.stat().st_mtime > _STALE:
                    partial.unlink()

    def expects(self, shape: Shape, method: Method, key: str) -> bool:
        """Set the key of the expected result, and return whether the result exists.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.
        key : str
            From `keys_of`.

        Returns
        -------
        bool
            True if nothing needs to be computed.
        """
        self._keys[shape, method.name] = key
        return self._key_in(self._path(shape, method)) == key

    def key(self, shape: Shape, method: Method) -> str:
        """Return the key of the expected result.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.

        Returns
        -------
        str
            The key; empty if no result is expected.
        """
        return self._keys.get((shape, method.name), "")

    def keep(self, shape: Shape, method: Method, outcome: Outcome, faces: np.ndarray | None = None) -> None:
        """Write the expected result.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.
        outcome : Outcome
            The result.
        faces : (m, 3) ndarray of int, optional
            Triangles, stored once per shape.
        """
        arrays = {"form": outcome.form, "descriptor": outcome.descriptor, "pairs": outcome.pairs, "faces": faces}
        head = {"key": self.key(shape, method), "row": outcome.row, "cost": outcome.cost}
        self._write(self._path(shape, method), head, {name: each for name, each in arrays.items() if each is not None})

    def result(self, shape: Shape, method: Method) -> dict[str, Any] | None:
        """Read the figures of a result.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.

        Returns
        -------
        dict or None
            ``row`` and ``cost``, as in `Outcome`; None if the expected result does not exist.
        """
        head = self._head(self._path(shape, method))
        return head if head is not None and head.get("key") == self.key(shape, method) else None

    def array(self, shape: Shape, method: Method, name: str) -> np.ndarray | None:
        """Read one array of a result.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.
        name : {'form', 'descriptor', 'pairs', 'faces'}
            Which array.

        Returns
        -------
        ndarray or None
            The array; None if the expected result does not have it.
        """
        try:
            with np.load(self._path(shape, method)) as stored:
                wanted = json.loads(bytes(stored["head"]))["key"] == self.key(shape, method)
                return np.asarray(stored[name]) if wanted else None
        except _BROKEN:
            return None

    def has(self, name: str, key: str) -> bool:
        """Return whether a comparison of shapes exists.

        Parameters
        ----------
        name : str
            Its name.
        key : str
            Key of its inputs.

        Returns
        -------
        bool
            True if nothing needs to be computed.
        """
        return self._key_in(self._results / f"{name}.npz") == key

    def keep_comparison(self, name: str, key: str, figures: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
        """Write a comparison of shapes.

        Parameters
        ----------
        name : str
            Its name.
        key : str
            Key of its inputs.
        figures : dict
            Scalar figures.
        arrays : dict of str to ndarray
            Arrays.
        """
        self._write(self._results / f"{name}.npz", {"key": key, "figures": figures}, arrays)

    def comparison(self, name: str, key: str) -> tuple[dict[str, Any], dict[str, np.ndarray]] | None:
        """Read a comparison of shapes.

        Parameters
        ----------
        name : str
            Its name.
        key : str
            Key that its inputs must have.

        Returns
        -------
        (dict, dict) or None
            The figures and the arrays; None if there is none.
        """
        path = self._results / f"{name}.npz"
        head = self._head(path)
        if head is None or head.get("key") != key:
            return None
        with np.load(path) as stored:
            return head.get("figures", {}), {each: stored[each] for each in stored.files if each != "head"}

    def write_text(self, name: str, text: str) -> Path:
        """Write a file of the report, atomically.

        Parameters
        ----------
        name : str
            Its name in the output folder.
        text : str
            Its content.

        Returns
        -------
        Path
            The file.
        """
        path = self.folder / name
        with _replacing(path) as stream:
            stream.write(text.encode())
        return path

    def write_picture(self, name: str, figure: Figure) -> Path:
        """Write an image, atomically.

        Parameters
        ----------
        name : str
            Its name in the output folder.
        figure : matplotlib.figure.Figure
            The figure.

        Returns
        -------
        Path
            The file.
        """
        path = self.folder / name
        with _replacing(path) as stream:
            figure.savefig(stream, dpi=_DOTS, format="png", metadata={"Software": None})
        return path

    def _path(self, shape: Shape, method: Method) -> Path:
        return self._results / method.name / shape.label / f"{shape.name}.npz"

    def _write(self, path: Path, head: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        with _replacing(path) as stream:
            np.savez(stream, head=np.frombuffer(json.dumps(head).encode(), dtype=np.uint8), **arrays)

    def _head(self, path: Path) -> dict[str, Any] | None:
        try:
            with np.load(path) as stored:
                return dict(json.loads(bytes(stored["head"])))
        except _BROKEN:
            return None

    def _key_in(self, path: Path) -> str | None:
        head = self._head(path) if path.is_file() else None
        return None if head is None else str(head.get("key"))


class _replacing:
    """A file that atomically replaces another when it is complete."""

    def __init__(self, path: Path) -> None:
        self._path, self._beside = path, path.with_name(f".{path.name}.{os.getpid()}.partial")

    def __enter__(self) -> BinaryIO:
        self._stream = self._beside.open("wb")
        return self._stream

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self._stream.flush()
            os.fsync(self._stream.fileno())
        self._stream.close()
        if kind is None:
            self._beside.replace(self._path)
        else:
            self._beside.unlink(missing_ok=True)


def file_digest(path: Path) -> str:
    """Return the digest of a file's content.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    str
        The digest.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    return hashlib.sha256(path.read_bytes()).hexdigest()


def keys_of(path: Path, methods: Sequence[Method]) -> list[str]:
    """Return the keys of results: they change with the mesh file, the settings and the code.

    Parameters
    ----------
    path : Path
        The mesh file.
    methods : sequence of Method
        The methods.

    Returns
    -------
    list of str
        One key per method.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    content = file_digest(path)
    settings = ["" if each.settings is None else json.dumps(asdict(each.settings), sort_keys=True) for each in methods]
    return [digest(content, path.suffix.lower(), each, code_version()) for each in settings]


_MATTER = (  # in addition to the core
    "blender/files/misread_files.py",
    "blender/files/obj_format.py",
    "blender/files/off_format.py",
    "blender/files/plain_files.py",
    "blender/files/ply_format.py",
    "blender/files/polygon_mesh.py",
    "blender/files/reading_files.py",
    "blender/objects/mesh_reading.py",
    "evaluation/correspondences/matchers.py",
    "evaluation/correspondences/work.py",
    "evaluation/descriptor.py",
    "evaluation/pair_descriptor.py",
    "evaluation/reading.py",
    "evaluation/remeshing.py",
    "evaluation/rigs/automatic.py",
    "evaluation/rigs/characters.py",
    "evaluation/rigs/work.py",
    "evaluation/work.py",
)


@cache
def code_version() -> str:
    """Return the digest of the code that results depend on.

    Returns
    -------
    str
        The digest.
    """
    root = Path(__file__).resolve().parents[1]
    files = sorted((root / "core").rglob("*.py"))
    files += [root / each for each in _MATTER]
    return digest(*(path.read_text(encoding="utf-8") for path in files))


def digest(*parts: str) -> str:
    """Return one short digest of several texts.

    Parameters
    ----------
    *parts : str
        The texts.

    Returns
    -------
    str
        The digest.
    """
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]
