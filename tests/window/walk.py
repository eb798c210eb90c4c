"""A random walk in a real window, with undo and redo: ``run.py --session tests/window/walk.py``.

Run by Blender itself, as `session.py` is; ``CANONICAL_FORM_WALK=seed:steps`` sets where chance starts
and how far to go.
"""

import os
import sys
from pathlib import Path

import bpy

PACKAGE, PICTURES, *_ = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :])
sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[2])]

from tests.window.driving import drive  # noqa: E402
from tests.window.hand import Hand  # noqa: E402

SEED, STEPS = map(int, os.environ.get("CANONICAL_FORM_WALK", "1:500").split(":"))
hand = Hand(PICTURES)


def walk():
    from tests.blender.walks import Walk
    from tests.meshes import shapes

    bpy.ops.extensions.package_install_files(
        filepath=str(PACKAGE), repo="user_default", enable_on_install=True, overwrite=True
    )
    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        taken = Walk("bl_ext.user_default.canonical_form.addon", shapes.figure(12), SEED, undo=True)
        try:
            taken.run(STEPS)
        finally:
            print(len(taken.steps), "steps:", taken.counts, "the last:", taken.steps[-8:], flush=True)
    yield 0.1


drive(walk(), "RANDOM WALK PASSED")
