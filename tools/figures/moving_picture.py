"""Draws the README's animation, a posed figure that unbends into its canonical form: `make moving-picture`."""

import sys
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.blender.objects.mesh_reading import read_mesh  # noqa: E402
from addon.core import canonical_form, limb_shapes  # noqa: E402
from addon.evaluation.pictures import drawn  # noqa: E402
from tools.figures.drawing import FRONT, colours_by_patch  # noqa: E402
from tools.sample.posed_figure import build  # noqa: E402

TARGET = ROOT / "docs" / "pictures" / "unbending.gif"
FRAMES, STILL = 18, 10  # between pose and form; at either end
SIDE, MILLISECONDS = 360, 50


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = read_mesh(build(levels=2).data)
    found = canonical_form(vertices, faces)
    ways = [float((1 - np.cos(np.pi * step / FRAMES)) / 2) for step in range(FRAMES + 1)]  # slow at both ends
    shapes = limb_shapes(vertices, faces, found.vertices, np.ones(len(vertices), dtype=bool), ways=ways)
    extent = 1.12 * float(max(np.ptp(shape, axis=0).max() for shape in shapes))
    colours = colours_by_patch(found.patches)
    pictures = [Image.fromarray(drawn(shape, faces, FRONT, 2 * SIDE, colours, extent)) for shape in shapes]
    images = [each.resize((SIDE, SIDE)).quantize(64, dither=Image.Dither.NONE) for each in pictures]
    loop = [*[images[0]] * STILL, *images, *[images[-1]] * STILL, *images[::-1]]
    loop[0].save(TARGET, save_all=True, append_images=loop[1:], duration=MILLISECONDS, loop=0, optimize=True)
    print(f"{TARGET}: {len(loop)} frames, {TARGET.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
