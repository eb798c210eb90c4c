"""Renders the README's animation, a posed figure that unbends into its canonical form: `make moving-picture`."""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.blender.mesh_items.palette import colours_of  # noqa: E402
from addon.blender.objects.mesh_reading import read_mesh  # noqa: E402
from addon.core import canonical_form, limb_shapes  # noqa: E402
from tools.sample.picture import camera, light, material  # noqa: E402
from tools.sample.posed_figure import build  # noqa: E402

TARGET = ROOT / "docs" / "pictures" / "unbending.gif"
FRAMES, STILL = 18, 10  # between pose and form; at either end
SIDE, SAMPLES, MILLISECONDS = 360, 16, 50


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    body = build(levels=2)
    vertices, faces = read_mesh(body.data)
    found = canonical_form(vertices, faces)
    ways = [float((1 - np.cos(np.pi * step / FRAMES)) / 2) for step in range(FRAMES + 1)]  # slow at both ends
    shapes = limb_shapes(vertices, faces, found.vertices, np.ones(len(vertices), dtype=bool), ways=ways)
    size = stage(body, colours_of(found.adf, found.patches, faces).patches, vertices, found.vertices)
    with tempfile.TemporaryDirectory() as folder:
        images = [frame(body, shape, size, Path(folder) / f"{number}.png") for number, shape in enumerate(shapes)]
    loop = [*[images[0]] * STILL, *images, *[images[-1]] * STILL, *images[::-1]]
    loop[0].save(TARGET, save_all=True, append_images=loop[1:], duration=MILLISECONDS, loop=0, optimize=True)
    print(f"{TARGET}: {len(loop)} frames, {TARGET.stat().st_size / 1e3:.0f} kB")


def stage(body: bpy.types.Object, colours: np.ndarray, pose: np.ndarray, form: np.ndarray) -> float:
    """Colour the figure and set up camera, light and renderer; return the size of the visible area."""
    body.modifiers.clear()
    body.data.materials.clear()
    body.data.materials.append(material(body.data, colours.astype(np.float32).ravel()))
    size = float(max(np.ptp(pose, axis=0).max(), np.ptp(form, axis=0).max()))
    camera(size)
    bpy.context.scene.camera.data.ortho_scale = 1.12 * size
    light(size)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", SAMPLES, False
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.view_settings.view_transform = "Standard"
    return size


def frame(body: bpy.types.Object, shape: np.ndarray, size: float, path: Path) -> Image.Image:
    """Render one shape in the centre of the picture."""
    centred = shape - (shape.max(axis=0) + shape.min(axis=0)) / 2 - [0.0, 0.0, 0.04 * size]
    body.data.vertices.foreach_set("co", centred.astype(np.float32).ravel())
    body.data.update()
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return Image.open(path).convert("RGB").quantize(64, dither=Image.Dither.NONE)


if __name__ == "__main__":
    main()
