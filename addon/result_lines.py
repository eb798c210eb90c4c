"""Keeps standard output for result lines: what Blender itself prints goes to standard error."""

from __future__ import annotations

import os
import sys
from typing import TextIO


def claim_output() -> TextIO:
    """Take standard output away from everyone else until the process ends.

    Blender's own lines wait in a buffer and may come out at the very end, so there is no giving it back.

    Returns
    -------
    TextIO
        The true standard output; file descriptor 1 leads to standard error from now on.
    """
    sys.stdout.flush()
    output = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    return output
