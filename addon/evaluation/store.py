"""Keeps results on disk, each in a file of its own that is whole or not there, so that a run can be taken up again."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from .dataset import Shape
from .methods import Method
from .work import Outcome

_BROKEN = (OSError, ValueError, KeyError, EOFError)  # what reading a file of another's making may raise


class Store:
    """The results of one evaluation.

    Parameters
    ----------
    folder : Path
        The output folder; results go to ``results`` in it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._results = folder / "results"
        self._results.mkdir(parents=True, exist_ok=True)
        for partial in self._results.rglob("*.partial"):  # of a run that was killed while it wrote
            partial.unlink(missing_ok=True)

    def has(self, shape: Shape, method: Method, key: str) -> bool:
        """Tell whether a result is there and was made from the same mesh, by the same settings and code.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.
        key : str
            From `key_of`.

        Returns
        -------
        bool
            Whether nothing needs to be done.
        """
        return self._key_in(self._path(shape, method)) == key

    def keep(self, shape: Shape, method: Method, key: str, outcome: Outcome, faces: np.ndarray | None = None) -> None:
        """Write a result.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.
        key : str
            From `key_of`.
        outcome : Outcome
            The result.
        faces : (m, 3) ndarray of int, optional
            Triangles, kept once a shape.
        """
        arrays = {"form": outcome.form, "descriptor": outcome.descriptor, "faces": faces}
        head = {"key": key, "row": outcome.row, "cost": outcome.cost}
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
            ``row`` and ``cost``, as in `Outcome`; None if there is no result.
        """
        return self._head(self._path(shape, method))

    def array(self, shape: Shape, method: Method, name: str) -> np.ndarray | None:
        """Read one array of a result.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.
        name : {'form', 'descriptor', 'faces'}
            Which.

        Returns
        -------
        ndarray or None
            The array; None if there is none.
        """
        try:
            with np.load(self._path(shape, method)) as stored:
                return np.asarray(stored[name])
        except _BROKEN:
            return None

    def has_distances(self, name: str, key: str) -> bool:
        """Tell whether a row of Hausdorff distances is there.

        Parameters
        ----------
        name : str
            Name of the row.
        key : str
            Of what it was made from.

        Returns
        -------
        bool
            Whether nothing needs to be done.
        """
        return self._key_in(self._results / f"{name}.npz") == key

    def keep_distances(self, name: str, key: str, distances: list[float]) -> None:
        """Write a row of Hausdorff distances.

        Parameters
        ----------
        name : str
            Name of the row.
        key : str
            Of what it was made from.
        distances : list of float
            The row.
        """
        self._write(self._results / f"{name}.npz", {"key": key}, {"distances": np.array(distances)})

    def distances(self, name: str) -> np.ndarray | None:
        """Read a row of Hausdorff distances.

        Parameters
        ----------
        name : str
            Name of the row.

        Returns
        -------
        ndarray or None
            The row; None if there is none.
        """
        try:
            with np.load(self._results / f"{name}.npz") as stored:
                return np.asarray(stored["distances"])
        except _BROKEN:
            return None

    def key_of_result(self, shape: Shape, method: Method) -> str | None:
        """Read the key that a result was kept under.

        Parameters
        ----------
        shape : Shape
            The shape.
        method : Method
            The method.

        Returns
        -------
        str or None
            The key; None if there is no result.
        """
        return self._key_in(self._path(shape, method))

    def write_text(self, name: str, text: str) -> Path:
        """Write a file of the report; it is replaced in one step.

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
        return None if head is None else str(head["key"])


class _replacing:
    """A file that takes the place of another in one step when it is whole."""

    def __init__(self, path: Path) -> None:
        self._path, self._beside = path, path.with_name(f".{path.name}.{os.getpid()}.partial")

    def __enter__(self) -> BinaryIO:
        self._stream = self._beside.open("wb")
        return self._stream

    def __exit__(self, kind: object, *_: object) -> None:
        self._stream.close()
        if kind is None:
            self._beside.replace(self._path)
        else:
            self._beside.unlink(missing_ok=True)


def key_of(path: Path, method: Method) -> str:
    """Make the key of a result: it changes with the mesh's file, the settings and the code.

    Parameters
    ----------
    path : Path
        The mesh's file.
    method : Method
        The method.

    Returns
    -------
    str
        The key.
    """
    settings = "" if method.settings is None else json.dumps(asdict(method.settings), sort_keys=True)
    return digest(_content(path), settings, code_version())


@cache
def _content(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@cache
def code_version() -> str:
    """Make a key of the code that results depend on.

    Returns
    -------
    str
        The key.
    """
    here = Path(__file__).resolve().parent
    files = [
        *sorted((here.parent / "core").rglob("*.py")),
        here / "work.py",
        here / "descriptor.py",
        here / "reading.py",
    ]
    return digest(*(path.read_text() for path in files))


def digest(*parts: str) -> str:
    """Make one short key of several texts.

    Parameters
    ----------
    *parts : str
        The texts.

    Returns
    -------
    str
        The key.
    """
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]
