"""Random walks; CANONICAL_FORM_WALKS=20,500 makes twenty of 500 steps instead of a short one."""

import os

import bpy
import pytest

from tests.blender.walks import Walk
from tests.meshes import shapes

WALKS, STEPS = map(int, os.environ.get("CANONICAL_FORM_WALKS", "1,80").split(","))


@pytest.mark.parametrize("seed", range(1, WALKS + 1))
def test_a_walk(blender, seed):
    bpy.context.preferences.filepaths.save_version = 0
    Walk("addon", shapes.figure(12), seed).run(STEPS)
