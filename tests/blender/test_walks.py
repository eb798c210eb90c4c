import bpy
import pytest

from tests.blender.walks import Walk
from tests.meshes import shapes


@pytest.mark.parametrize("seed", [1, 2])
def test_a_short_walk(blender, seed):
    bpy.context.preferences.filepaths.save_version = 0
    Walk("addon", shapes.figure(12), seed).run(60)
