"""Rigs from the command line: what arrives in a file for Blender, and for other programs."""

from pathlib import Path

import numpy as np
import pytest

from tests.commands import run

bpy = pytest.importorskip("bpy")
from addon.blender.files.reading_files import open_meshes  # noqa: E402
from addon.blender.rigging.rig_clearing import armature_given_to  # noqa: E402
from tests.blender.conftest import add_object  # noqa: E402
from tests.blender.rig_scenes import shown  # noqa: E402


@pytest.fixture
def path(tmp_path, blender, scan, lender):
    """A file with a mannequin that is bent."""
    add_object("Body", scan, lender.faces)
    path = tmp_path / "scan.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_a_scan_gets_a_rig_in_a_file_of_blender(path, tmp_path, motions, lender):
    code, lines, _ = run(path, "--output", tmp_path / "out", "--rest", "none", "--anyway", about="rig")
    assert (code, lines[0]["armature"], lines[0]["reference"]) == (0, "Rig of Body", "mannequin")
    assert lines[0]["bones"]["upper_arm.L"] > 0.3
    (obj,) = open_meshes(Path(lines[0]["output"]))
    armature = armature_given_to(obj)
    assert armature is not None
    for name in ("upper_arm.L", "forearm.R", "thigh.R", "shin.L"):
        head = np.array(armature.matrix_world @ armature.data.bones[name].head_local)
        true = motions.heads[lender.skeleton.names.index(name)]
        assert np.linalg.norm(head - true) < 0.04, name


def test_other_programs_get_the_rest_as_the_mesh(path, tmp_path):
    code, lines, _ = run(path, "--output", tmp_path / "out", "--format", "glb", "--anyway", about="rig")
    assert code == 0
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=lines[0]["output"])
    (obj,) = (each for each in bpy.data.objects if each.type == "MESH" and each.vertex_groups)
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "Scan"]
    points = shown(obj)
    arms = np.ptp(points[:, 0])
    assert 0.85 < arms / np.ptp(points[:, 2]) < 1.15  # it stands in a T


def test_a_character_lends_its_bones(path, tmp_path):
    _, lines, _ = run(path, "--output", tmp_path / "one", "--rest", "none", "--anyway", about="rig")
    code, others, _ = run(
        path,
        "--output",
        tmp_path / "two",
        "--reference",
        lines[0]["output"],
        "--rest",
        "reference",
        "--anyway",
        about="rig",
    )
    assert code == 0
    assert set(others[0]["bones"]) == set(lines[0]["bones"])
    (obj,) = open_meshes(Path(others[0]["output"]))
    assert sum(each.type == "ARMATURE" for each in bpy.data.objects) == 1
    assert "Rest Pose at Rest" in obj.data.shape_keys.key_blocks


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--format", "obj"), "holds no armature"),
        (("--mesh", "shown"), "works on the mesh itself"),
        (("--rigify", "--names", "vrm"), "leave out --reference and --names"),
    ],
)
def test_what_cannot_be_is_told(path, tmp_path, words, sentence):
    code, _, errors = run(path, "--output", tmp_path / "out", *words, about="rig")
    assert code == 2
    assert sentence in errors
