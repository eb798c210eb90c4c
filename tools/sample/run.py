"""The main job on a sample: `make run`.

Builds a posed figure, runs the operator on it, and writes a .blend file and a picture to `build/`, and a clothed,
rigged character to try in a window.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import addon  # noqa: E402
from addon.blender.files.reading_files import quiet  # noqa: E402
from addon.blender.files.writing_files import Shown, save_forms  # noqa: E402
from addon.blender.objects.mesh_reading import read_mesh  # noqa: E402
from addon.blender.records.record import require_record  # noqa: E402
from tools.sample import clothed_figure  # noqa: E402
from tools.sample.picture import draw  # noqa: E402
from tools.sample.posed_figure import build  # noqa: E402

OUTPUT = ROOT / "build"


def main(levels: int) -> None:
    OUTPUT.mkdir(exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    figure = build(levels=levels)
    save_upright(OUTPUT / "figure-posed.obj", figure)  # for any Blender
    print(f"Built a posed figure of {len(figure.data.vertices):,} vertices. Taking its pose out …", flush=True)
    bpy.ops.object.canonical_form()
    report = require_record(figure.data).report
    print(
        f"{len(report.feature_points)} feature points; edge distortion {report.edge_distortion or 0.0:.1%} (median); "
        f"{report.seconds:.1f} s",
        flush=True,  # `quiet` discards what is still in the buffer
    )
    for warning in report.warnings:
        print(f"Warning: {warning}", flush=True)
    blend, picture = OUTPUT / "figure.blend", OUTPUT / "figure.png"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    draw(figure, picture)
    addon.unregister()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    clothed_figure.build(levels=levels)
    with quiet():
        bpy.ops.export_scene.gltf(
            filepath=str(OUTPUT / "clothed.glb"), export_animations=False, export_rest_position_armature=False
        )
    print(
        f"Open in Blender {bpy.app.version[0]}.{bpy.app.version[1]} or later: {blend}\n"
        f"To try, in any Blender: {OUTPUT / 'figure-posed.obj'}\n"
        f"A clothed character under a rig, to import: {OUTPUT / 'clothed.glb'}\n"
        f"Before and after: {picture}"
    )


def save_upright(path: Path, figure: bpy.types.Object) -> None:
    """Write an object to an .obj file with Y up, as importers expect it."""
    vertices, _ = read_mesh(figure.data)
    turned = vertices[:, [0, 2, 1]] * (1.0, 1.0, -1.0)
    save_forms(path, [Shown(figure, turned, np.full(len(vertices), -1), np.ones((len(vertices), 4)))])


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2)
