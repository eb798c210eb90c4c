"""Random walks; CANONICAL_FORM_WALKS=20,500 makes twenty of 500 steps instead of a short one.

CANONICAL_FORM_SCENES=500 lets Hypothesis make as many short ones, and find the shortest that fails.
"""

import os

import bpy
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.blender.walks import Walk
from tests.meshes import shapes

SCENES = int(os.environ.get("CANONICAL_FORM_SCENES", "8"))
WALKS, STEPS = map(int, os.environ.get("CANONICAL_FORM_WALKS", "1,80").split(","))


@pytest.mark.parametrize("seed", range(1, WALKS + 1))
def test_a_walk(blender, seed):
    bpy.context.preferences.filepaths.save_version = 0
    Walk("addon", shapes.figure(12), seed).run(STEPS)


@settings(
    max_examples=SCENES,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(chance=st.randoms(use_true_random=False), steps=st.integers(3, 15))
def test_any_scene(blender, chance, steps):
    """What is the user's survives whatever is done in whatever scene."""
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.armatures, *bpy.data.actions])
    Walk("addon", shapes.figure(12), chance).run(steps)
