"""Draws the README's animations: `make moving-picture`. A posed figure unbends into its form; a scan is put into a
T-pose, gets a rig, and waves.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.blender.objects.mesh_reading import read_mesh  # noqa: E402
from addon.core import canonical_form, limb_shapes, rig  # noqa: E402
from addon.core.rigging.skeleton import moved_skeleton, skinned  # noqa: E402
from addon.evaluation.pictures import drawn  # noqa: E402
from tests.meshes.bent_rigs import posed  # noqa: E402
from tools.figures import t_poses  # noqa: E402
from tools.figures.drawing import BALL, FRONT, colours_by_patch  # noqa: E402
from tools.figures.rigs import BEFORE, WAVE, spindles  # noqa: E402
from tools.sample.posed_figure import build  # noqa: E402

PICTURES = ROOT / "docs" / "pictures"
FRAMES, STILL = 18, 10  # from one shape to the next; at either end
SIDE, MILLISECONDS = 360, 50
GREY = [205.0, 205.0, 212.0]


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    save("unbending.gif", unbending(), 64)
    save("scan-to-rig.gif", scan_to_rig(), 48)


def eased(count: int) -> list[float]:
    """Return shares of a way, slow at both ends."""
    return [float((1 - np.cos(np.pi * step / count)) / 2) for step in range(count + 1)]


def unbending() -> list[Image.Image]:
    """A posed figure unbends, and back."""
    vertices, faces = read_mesh(build(levels=2).data)
    found = canonical_form(vertices, faces)
    shapes = limb_shapes(vertices, faces, found.vertices, np.ones(len(vertices), dtype=bool), ways=eased(FRAMES))
    extent = 1.12 * float(max(np.ptp(shape, axis=0).max() for shape in shapes))
    colours = colours_by_patch(found.patches)
    images = [Image.fromarray(drawn(shape, faces, FRONT, 2 * SIDE, colours, extent)) for shape in shapes]
    return [*[images[0]] * STILL, *images, *[images[-1]] * STILL, *images[::-1]]


def scan_to_rig() -> list[Image.Image]:
    """A scan in stride takes a T-pose, gets bones, and is posed by them."""
    vertices, faces = t_poses.figure_in_stride()
    found = rig(vertices, faces, pose="T")
    whole = np.ones(len(vertices), dtype=bool)
    ways = eased(FRAMES)
    stands = limb_shapes(vertices, faces, found.vertices, whole, ways=ways)
    waves = [posed(found, {bone: tuple(way * np.array(bend)) for bone, bend in WAVE.items()}) for way in ways]
    extent = 1.15 * float(np.ptp(found.vertices, axis=0).max())

    def image(points: np.ndarray, title: str, skeleton=None) -> Image.Image:
        parts, triangles, colours = [points], [faces], [np.tile(GREY, (len(points), 1))]
        if skeleton is not None:
            bones, corners = spindles(skeleton)
            parts.append(bones + BEFORE * t_poses.FRONT[:, 2])
            triangles.append(corners + len(points))
            colours.append(np.tile(BALL, (len(bones), 1)))
        body, corners, paint = (np.concatenate(each) for each in (parts, triangles, colours))
        picture = Image.fromarray(drawn(body, corners, t_poses.FRONT, 2 * SIDE, paint, extent))
        ImageDraw.Draw(picture).text((24, 20), title, fill=(90, 90, 90), font=ImageFont.load_default(size=36))
        return picture

    standing = [image(points, "Scan" if way < 1 else "T-Pose", None) for points, way in zip(stands, ways, strict=True)]
    rigged = image(found.vertices, "Rig", found.skeleton)
    waving = [
        image(skinned(found.vertices, found.weights, each), "Posed", moved_skeleton(found.skeleton, each))
        for each in waves
    ]
    ends = [[each] * STILL for each in (standing[0], standing[-1], rigged, waving[-1])]
    return [*ends[0], *standing, *ends[1], *ends[2], *waving, *ends[3], *waving[::-1], *standing[::-1]]


def save(name: str, images: list[Image.Image], colours: int) -> None:
    """Write a moving picture."""
    made = {id(each): each.resize((SIDE, SIDE)).quantize(colours, dither=Image.Dither.NONE) for each in images}
    first, *others = [made[id(each)] for each in images]
    target = PICTURES / name
    first.save(target, save_all=True, append_images=others, duration=MILLISECONDS, loop=0, optimize=True)
    print(f"{target}: {len(images)} frames, {target.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
