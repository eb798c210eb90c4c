"""Measures a run at quality Full on a figure of about 9,800 vertices with five limbs: time, memory, saved pairs.

Run ``.venv/bin/python tools/benchmarks/figure.py``.
"""

import resource
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.core import Settings, canonical_form
from tests.meshes.shapes import figure

if __name__ == "__main__":
    vertices, faces = figure(52)
    settings = Settings(quality="full")
    asked = [time.perf_counter()]

    def never() -> bool:
        asked.append(time.perf_counter())
        return False

    form = canonical_form(vertices, faces, settings, cancelled=never)
    print(f"{len(vertices):,} vertices, {len(form.feature_points)} patches")
    print(f"{form.pair_count / 1e6:.1f} million pair distances, {form.pair_reduction:.1%} less than {len(vertices)}²")
    print(", ".join(f"{stage} {seconds:.1f} s" for stage, seconds in form.timings.items()))
    print(f"{sum(form.timings.values()):.1f} s in all; longest wait of a cancel {np.diff(asked).max():.2f} s")
    print(f"Peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")
