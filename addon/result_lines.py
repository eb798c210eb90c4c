"""Reserves standard output for result lines: what Blender prints goes to standard error."""

from __future__ import annotations

import os
import sys
from typing import TextIO


def claim_output() -> TextIO:
    """Reserve standard output for the caller until the process ends.

    This is permanent, as Blender's own output is buffered and may be printed at the very end.

    Returns
    -------
    TextIO
        The original standard output; file descriptor 1 is redirected to standard error.
    """
    sys.stdout.flush()
    output = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    return output
