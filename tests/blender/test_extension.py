"""The packed extension, installed by Blender's own installer into an empty home, in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

STEPS = """
import sys, bpy, addon_utils
before = set(dir(bpy.types)), set(dir(bpy.types.Scene))
bpy.ops.extensions.package_install_files(filepath={zip!r}, repo="user_default", enable_on_install=True)
assert hasattr(bpy.types.Scene, "canonical_form")
name = "bl_ext.user_default.canonical_form"
assert not any(module.startswith("scipy") for module in sys.modules), "scipy is imported on first use"
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.modifier_add(type="SUBSURF")
bpy.context.object.modifiers[0].levels = 3
bpy.ops.object.modifier_apply(modifier=bpy.context.object.modifiers[0].name)
assert bpy.ops.object.canonical_form(iterations=3, eigenpairs=30) == {{"FINISHED"}}
assert "Canonical Form" in bpy.context.object.data.shape_keys.key_blocks
assert bpy.ops.object.canonical_form_clear() == {{"FINISHED"}}
addon_utils.disable(name, default_set=True)
assert (set(dir(bpy.types)), set(dir(bpy.types.Scene))) == before, "something is left behind"
addon_utils.enable(name, default_set=True)
assert hasattr(bpy.types.Scene, "canonical_form")
repositories = [each.module for each in bpy.context.preferences.extensions.repos]
bpy.ops.extensions.package_uninstall(repo_index=repositories.index("user_default"), pkg_id="canonical_form")
assert not hasattr(bpy.types.Scene, "canonical_form")
print("PASSED", bpy.app.version_string)
"""


@pytest.fixture(scope="module")
def package():
    subprocess.run([sys.executable, "tests/package.py", "--here"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return next((ROOT / "build" / "here").glob("canonical_form-*.zip"))


def test_it_installs_enables_runs_disables_and_uninstalls(package, tmp_path):
    steps = STEPS.format(zip=str(package))
    done = subprocess.run(
        [sys.executable, "-c", steps],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert "PASSED" in done.stdout, done.stdout + done.stderr
    assert "Traceback" not in done.stderr, done.stderr
