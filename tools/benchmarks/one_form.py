"""The form of one mesh in a process of its own: its seconds by stage, and the memory that it takes; Linux only.

A process that made the mesh, or imported what the form imports, would use that memory again.
"""

import json
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from addon.core import Settings, canonical_form
from addon.core.method_api.costs import memory_estimate


def main(mesh: str, **settings: Any) -> None:
    with np.load(mesh) as stored:
        vertices, faces = stored["vertices"], stored["faces"]
    Path("/proc/self/clear_refs").write_text("5")  # resets the peak
    before, began, chosen = gigabytes("VmRSS"), perf_counter(), Settings(**settings)
    form = canonical_form(vertices, faces, chosen)
    seconds, peak = perf_counter() - began, gigabytes("VmHWM")
    row = {
        "vertices": len(vertices),
        "features": len(form.feature_points),
        "seconds": seconds,
        "GB": peak,
        "of the form, GB": peak - before,
        "estimate, GB": memory_estimate(len(vertices), chosen),
        "pairs": form.pair_count,
        "pairs saved": form.pair_reduction,
    }
    print(json.dumps([row, form.timings]))


def gigabytes(name: str) -> float:
    """Read a figure about this process from Linux."""
    status = Path("/proc/self/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith(f"{name}:")).split()[1]) / 1e6


if __name__ == "__main__":
    main(sys.argv[1], **json.loads(sys.argv[2]))
