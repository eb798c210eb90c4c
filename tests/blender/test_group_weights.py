"""Weights of vertex groups: those read at once are those that Blender gives one at a time."""

import bpy
import numpy as np
import pytest

from addon.blender.mesh_items.fingerprints import group_fingerprints, members_fingerprint
from addon.blender.mesh_items.group_weights import fill_group
from addon.blender.mesh_items.weight_reading import weights_of


@pytest.fixture
def weighted():
    """An object with a moved shape key, and four groups with all kinds of weights; the last is empty."""
    mesh = bpy.data.meshes.new("Weighted")
    mesh.from_pydata(np.random.default_rng(0).normal(size=(500, 3)).tolist(), [], [])
    obj = bpy.data.objects.new("Weighted", mesh)
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Up").points.foreach_set("co", np.ones(1500, dtype=np.float32))
    rng = np.random.default_rng(1)
    for name in "ABC":
        group = obj.vertex_groups.new(name=name)
        for weight in (0.0, 1e-6, 0.1, 1 / 3, 1.0):
            group.add(rng.choice(500, 60, replace=False).tolist(), weight, "REPLACE")
    obj.vertex_groups.new(name="Empty")
    yield obj
    bpy.data.meshes.remove(mesh)


def members_one_by_one(obj, name):
    """Members and weights as Blender gives them."""
    number = obj.vertex_groups[name].index
    found = [(v.index, part.weight) for v in obj.data.vertices for part in v.groups if part.group == number]
    return np.array([index for index, _ in found], dtype=int), np.array([weight for _, weight in found])


def test_weights_read_at_once_are_those_read_one_at_a_time(weighted):
    names = ["A", "B", "C", "Empty"]
    found = weights_of(weighted, [*names, "Nobody"])
    assert list(found) == names
    for name in names:
        expected = np.zeros(500)
        members, weights = members_one_by_one(weighted, name)
        expected[members] = weights
        assert np.array_equal(found[name], expected)


def test_reading_weights_leaves_nothing_behind_and_changes_nothing(weighted):
    def state():
        kinds = ("meshes", "objects", "shape_keys")
        keys = weighted.data.shape_keys.key_blocks
        positions = [[tuple(point.co) for point in key.points] for key in keys]
        return [[each.name for each in getattr(bpy.data, kind)] for kind in kinds], positions, weighted.data.users

    before = state()
    weights_of(weighted, ["A", "B", "C"])
    assert state() == before


@pytest.mark.parametrize("right", [True, False], ids=["known", "other"])
def test_a_fingerprint_counts_members_of_weight_zero_unless_the_known_one_is_of_the_others(weighted, right):
    members, weights = members_one_by_one(weighted, "A")
    own = members_fingerprint(members, weights)
    assert (weights == 0).any()
    assert group_fingerprints(weighted, {"A": own if right else "another"}) == {"A": own}
    some = members_fingerprint(members[weights > 0], weights[weights > 0])
    assert group_fingerprints(weighted, {"A": some}) == {"A": some}
    weighted.vertex_groups["A"].add([int(members[weights > 0][0])], 0.5, "REPLACE")
    assert group_fingerprints(weighted, {"A": own})["A"] not in (own, some)


def test_a_filled_group_has_the_fingerprint_that_filling_returned(weighted):
    weights = np.linspace(-0.5, 1.0, 500)
    weights[::7] = np.nan
    group = weighted.vertex_groups["B"]
    known = fill_group(group, weights)
    assert group_fingerprints(weighted, {"B": known}) == {"B": known}
    assert weights_of(weighted, ["B"])["B"] == pytest.approx(np.nan_to_num(np.clip(weights, 0, 1)), abs=5e-4 + 1e-7)


def test_the_only_group_has_no_members():
    mesh = bpy.data.meshes.new("Bare")
    mesh.from_pydata(np.eye(3).tolist(), [], [])
    obj = bpy.data.objects.new("Bare", mesh)
    obj.vertex_groups.new(name="A")
    assert weights_of(obj, ["A"])["A"].tolist() == [0.0, 0.0, 0.0]
    assert [group.name for group in obj.vertex_groups] == ["A"]
    assert not any(len(vertex.groups) for vertex in mesh.vertices)
    bpy.data.meshes.remove(mesh)


def test_a_mesh_without_vertices_has_groups_without_weights():
    obj = bpy.data.objects.new("Void", bpy.data.meshes.new("Void"))
    obj.vertex_groups.new(name="A")
    assert weights_of(obj, ["A"])["A"].shape == (0,)
    bpy.data.meshes.remove(obj.data)
