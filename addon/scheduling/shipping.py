"""Sends this code and its work to machines that do not have it, under a name that no other version has.

What travels through a cluster's scheduler is bytes alone, which the scheduler need not understand.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

PACKAGE = __name__.split(".scheduling")[0]  # the name of this code here
_PARTS = ("core", "scheduling", "evaluation", "blender", "batch")  # what a worker may need


def packed_code(folder: Path) -> tuple[Path, str]:
    """Pack the code that workers need into a file that Python can import from.

    Parameters
    ----------
    folder : Path
        Where to put it.

    Returns
    -------
    path : Path
        The file.
    name : str
        The name to import the code by: unlike that of any other version.
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
    """Make a function that runs pickled work where the code goes by another name, and pickles what comes of it.

    Parameters
    ----------
    name : str
        That name.

    Returns
    -------
    callable
        Takes ``pickle.dumps((function, arguments))`` and gives what `unpacked` reads. It refers to nothing of this
        code, so that it can be sent as it is.
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
    """Read what a remote runner gave.

    Parameters
    ----------
    result : bytes
        From the runner.
    name : str
        The name that the code goes by there.

    Returns
    -------
    object
        The result of the work.
    """

    class Renaming(pickle.Unpickler):
        def find_class(self, module: str, attribute: str) -> Any:
            if module == name or module.startswith(name + "."):
                module = PACKAGE + module[len(name) :]
            return super().find_class(module, attribute)

    return Renaming(io.BytesIO(result)).load()
