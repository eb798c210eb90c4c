"""Sends this code and its tasks to machines that do not have it, under a name unique to this version.

Only bytes pass through a cluster's scheduler, which does not need to understand them.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

PACKAGE = __name__.split(".scheduling")[0]  # the name of this package here
_PARTS = ("core", "scheduling", "evaluation", "blender", "batch")  # the subpackages that a worker may need


def packed_code(folder: Path) -> tuple[Path, str]:
    """Pack the code that workers need into a file from which Python can import.

    Parameters
    ----------
    folder : Path
        Where to write the file.

    Returns
    -------
    path : Path
        The file.
    name : str
        The name to import the package by, unique to this version.
    """
    root = Path(__file__).resolve().parents[1]
    sources = [path for part in _PARTS for path in sorted((root / part).rglob("*.py"))]
    texts = "\0".join(path.read_text(encoding="utf-8") for path in sources)
    name = f"canonical_form_{hashlib.sha256(texts.encode()).hexdigest()[:24]}"
    target = folder / f"{name}.zip"
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr(f"{name}/__init__.py", "")
        for path in sources:
            archive.write(path, Path(name) / path.relative_to(root))
    return target, name


def remote_runner(name: str) -> Callable[[bytes], bytes]:
    """Create a function that runs pickled tasks where the package has another name, and pickles their results.

    Parameters
    ----------
    name : str
        The name there.

    Returns
    -------
    callable
        Takes ``pickle.dumps((function, arguments))`` and returns what `unpacked` reads. It does not refer to this
        package, so that it can be sent as it is.
    """
    here = PACKAGE

    def run(work: bytes) -> bytes:
        import io
        import pickle

        class Renaming(pickle.Unpickler):
            def find_class(self, module: str, attribute: str) -> object:
                if module == here or module.startswith(here + "."):
                    module = name + module[len(here) :]
                return super().find_class(module, attribute)

        function, arguments = Renaming(io.BytesIO(work)).load()
        return pickle.dumps(function(*arguments))

    return run


def unpacked(result: bytes, name: str) -> Any:
    """Unpickle the result of a remote runner.

    Parameters
    ----------
    result : bytes
        Returned by the runner.
    name : str
        The name of the package there.

    Returns
    -------
    object
        The result of the task.
    """

    class Renaming(pickle.Unpickler):
        def find_class(self, module: str, attribute: str) -> Any:
            if module == name or module.startswith(name + "."):
                module = PACKAGE + module[len(name) :]
            return super().find_class(module, attribute)

    return Renaming(io.BytesIO(result)).load()
