"""Straight forms of bent tubes: ``tubes.py``. Closed tubes of length 4 and radius .12, bent or not, in three sizes.

Printed for each: the distance between the centres of the end rings over the length of the form's axis; that length over
the input's; girths of the rings over the input's, median and range without five rings at each end.
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import canonical_form  # noqa: E402
from tests.meshes.tubes import CURVES, length_of, rings, tube  # noqa: E402

SIZES = ((16, 100), (24, 160), (32, 240))  # vertices around and along


def main() -> None:
    print("| axis | vertices | ends over length | length | girth, median (range) |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for name, curve in CURVES.items():
        for around, along in SIZES:
            vertices, faces = tube(curve, around, along)
            axis, girths = rings(canonical_form(vertices, faces).vertices, around)
            before, own_girths = rings(vertices, around)
            girth = (girths / own_girths)[5:-5]
            straight = np.linalg.norm(axis[-1] - axis[0]) / length_of(axis)
            print(
                f"| {name} | {len(vertices):,} | {straight:.3f} | {length_of(axis) / length_of(before):.3f} |"
                f" {np.median(girth):.3f} ({girth.min():.2f} to {girth.max():.2f}) |",
                flush=True,
            )


if __name__ == "__main__":
    main()
