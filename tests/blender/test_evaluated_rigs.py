"""The evaluation of rigs: what is exact by construction, and a run on a file."""

import csv
import io

import numpy as np
import pytest

from addon.core import mannequin
from addon.core.mesh.coarsening import coarsened
from addon.core.rigging.reference_rig import mannequin_rig
from addon.core.rigging.skeleton import BoneMotions, skinned
from addon.evaluation.rigs import work
from addon.evaluation.rigs.characters import Character, random_pose
from addon.evaluation.rigs.command import main

bpy = pytest.importorskip("bpy")
from tests.blender.conftest import add_object  # noqa: E402


@pytest.fixture(scope="module")
def character():
    """The mannequin with two poses of random bones, and one whose hand has left its arm."""
    vertices, faces = mannequin()
    coarse = coarsened(vertices, faces, 1500)
    rig = mannequin_rig(vertices, faces).at(coarse.kept, coarse.faces)
    poses = {f"random {seed}": random_pose(rig, seed) for seed in range(2)}
    one = poses["random 1"]
    heads = one.heads.copy()
    heads[rig.skeleton.names.index("hand.L")] += [0.1, 0.0, 0.0]
    return Character("Figure", rig, {**poses, "pulled": one._replace(heads=heads)})


def test_random_poses_are_the_same_every_time_and_keep_joints_together(character):
    again = random_pose(character.rig, 0)
    np.testing.assert_array_equal(again.turns, character.poses["random 0"].turns)
    bones = character.rig.skeleton
    long = np.linalg.norm(bones.heads[1:] - bones.heads[bones.parents[1:]], axis=1)
    now = np.linalg.norm(again.heads[1:] - again.heads[bones.parents[1:]], axis=1)
    np.testing.assert_allclose(now, long, atol=1e-12)
    assert np.abs(again.turns - np.eye(3)).max() > 0.2


def test_the_true_rig_goes_into_new_poses_without_an_error(character):
    truth, rows = work._remeshed(character, "random 0")
    later = [work._later(character, truth, motions, rows) for motions in character.poses.values()]
    same = np.arange(len(truth.skeleton.names))
    figures = work._new_poses("", truth, truth.skeleton, truth.weights, same, later)
    # what was skinned once and is skinned on differs where bones share the skin
    assert figures["mean"] < 0.3
    hard = truth._replace(weights=np.eye(len(same))[truth.weights.argmax(axis=1)])
    points = [skinned(truth.vertices, hard.weights, _from(truth, each)) for each in later]
    later = [each._replace(vertices=own) for each, own in zip(later, points, strict=True)]
    figures = work._new_poses("", hard, truth.skeleton, hard.weights, same, later)
    assert figures["mean"] == pytest.approx(0.0, abs=1e-9)
    moved = truth.skeleton._replace(heads=truth.skeleton.heads + np.array([0.0, 0.0, 0.05 * truth.size]))
    assert work._new_poses("", hard, moved, hard.weights, same, later)["mean"] > 0.2
    assert work._joints(moved, hard.weights, hard, same.tolist())["joints"] == pytest.approx(5.0)


def _from(truth, later):
    return BoneMotions(truth.skeleton.heads, later.heads, later.turns)


def test_vertices_at_one_place_are_merged():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    kept, faces = work._merged(points, np.array([[0, 1, 2], [3, 5, 4], [1, 3, 0]]))
    assert len(kept) == 4
    assert len(faces) == 2  # the third has two corners at one place
    np.testing.assert_array_equal(points[kept][faces], points[[[0, 1, 2], [3, 5, 4]]])


def test_a_file_is_evaluated_and_a_second_run_goes_on(blender, tmp_path, character):
    rig = character.rig
    body = add_object("Figure", rig.vertices, rig.faces)
    data = bpy.data.armatures.new("Bones")
    armature = bpy.data.objects.new("Bones", data)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bones = rig.skeleton
    made = [data.edit_bones.new(name) for name in bones.names]
    for bone, head, tail, parent in zip(made, bones.heads, bones.tails, bones.parents, strict=True):
        bone.head, bone.tail = head, tail
        bone.parent = made[parent] if parent >= 0 else None
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, weights in zip(bones.names, rig.weights.T, strict=True):
        group = body.vertex_groups.new(name=name)
        for vertex in np.flatnonzero(weights > 1e-4):
            group.add([int(vertex)], float(weights[vertex]), "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = armature
    path = tmp_path / "figure.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    words = [str(path), "--output", str(tmp_path / "out"), "--references", "same", "--frames", "1", "--random", "1",
             "--workers", "1", "--automatic"]  # fmt: skip
    written = io.StringIO()
    assert main(words, written) == 0
    with (tmp_path / "out" / "rigs.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (row["character"], row["pose"], row["reference"]) == ("figure", "random 1", "same")
    assert float(row["joints"]) < 1.0
    assert float(row["mean"]) < 1.0
    assert 0 < float(row["true_mean"]) < 5
    before = (tmp_path / "out" / "rigs.csv").read_text()
    assert main(words, io.StringIO()) == 0
    assert (tmp_path / "out" / "rigs.csv").read_text() == before
    assert "| same | figure | 1 | 0 |" in (tmp_path / "out" / "rigs.md").read_text()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--random", "0", "--frames", "0"], "not both 0"),
        (["--workers", "0"], "at least 1"),
        ([], "bare"),
        (["--references", "same/mannequin.glb"], "Two characters are called mannequin"),
    ],
)
def test_what_cannot_be_done_is_a_sentence(blender, tmp_path, capsys, words, sentence):
    add_object("Body", *[np.eye(3), np.array([[0, 1, 2]])])
    path = tmp_path / "bare.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    assert main([str(path), "--output", str(tmp_path / "out"), *words], io.StringIO()) == 2
    assert sentence in capsys.readouterr().err
