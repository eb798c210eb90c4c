"""The file of result lines that --log names; a run that goes on where another stopped has each result in it once."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path

from ..blender.files.file_access import require_folder
from ..blender.files.replacing_files import replaced
from ..core.run.errors import CanonicalFormError
from .claims import claimed
from .lines import Line


class ReportLog:
    """The result lines of a run, and of those before it that it continues.

    Parameters
    ----------
    path : Path
        The file.
    continued : bool
        Whether to keep the lines of results that exist, in place of starting anew.

    Attributes
    ----------
    outputs : dict of str to list of str, or None
        Results that an earlier run has reported, by input; None if there was none.
    """

    def __init__(self, path: Path, continued: bool) -> None:
        require_folder(path.parent)
        self._open = ExitStack()
        if not self._open.enter_context(claimed(path)):
            self._open.close()
            raise CanonicalFormError(f"Another run writes to {path}. Choose another --log.")
        self.outputs: dict[str, list[str]] | None = None
        kept = []
        if continued and path.exists():
            self.outputs = {}
            for text in path.read_bytes().split(b"\n")[:-1]:  # without what a kill has cut off
                line = _parsed(text)
                output = line.get("output")
                if output and Path(output).exists() and "error" not in line:
                    kept.append(text)
                    self.outputs.setdefault(str(line.get("input")), []).append(output)
        replaced(path, lambda partial: partial.write_bytes(b"".join(text + b"\n" for text in kept)))
        self._file = self._open.enter_context(path.open("ab", buffering=0))

    def add(self, texts: list[str]) -> None:
        """Add lines, all at once, so that a kill cuts no result off from its other lines."""
        rest = "".join(f"{text}\n" for text in texts).encode()
        while rest:  # a disk that runs full takes a part
            rest = rest[self._file.write(rest) :]

    def close(self) -> None:
        """Close the file."""
        self._open.close()


def _parsed(text: bytes) -> Line:
    """Read a line; an empty one if it is none of ours."""
    try:
        line = json.loads(text)
    except ValueError:
        return {}
    return line if isinstance(line, dict) else {}
