"""What a *Rig* that fails leaves: everything as it was, and an earlier rig, if the new armature cannot be made."""

import bpy
import pytest

from addon import core
from addon.blender.rigging import rig_task
from addon.core import CanonicalFormError
from tests.blender.rig_scenes import RIG, scene


def test_a_failure_leaves_nothing(body, monkeypatch):
    before = scene()
    fill, calls = rig_task.fill_group, []

    def failing(group, weights):
        calls.append(group.name)
        if len(calls) > 4:
            raise MemoryError
        return fill(group, weights)

    monkeypatch.setattr(rig_task, "fill_group", failing)
    with pytest.raises(RuntimeError, match="memory"):
        bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert scene() == before


@pytest.mark.parametrize("maker", ["add_armature", "follow"])
def test_a_second_rig_that_cannot_be_made_leaves_the_first(body, monkeypatch, maker):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    before = scene()

    def failing(*_):
        raise CanonicalFormError("It fails.")

    made = getattr(rig_task, maker)
    monkeypatch.setattr(rig_task, maker, failing)
    with pytest.raises(RuntimeError, match="It fails"):
        bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    monkeypatch.setattr(rig_task, maker, made)
    if maker == "add_armature":
        assert scene() == before
    assert bpy.ops.object.canonical_form_rig(**RIG, rest="T") == {"FINISHED"}
    assert scene() == before


def test_a_mesh_that_was_edited_meanwhile_is_not_written(body, monkeypatch):
    found = core.rig

    def meanwhile(*arguments, **options):
        rigged = found(*arguments, **options)
        body.data.shape_keys.reference_key.data[0].co.x += 1
        return rigged

    monkeypatch.setattr(core, "rig", meanwhile)
    with pytest.raises(RuntimeError, match="was edited while"):
        bpy.ops.object.canonical_form_rig(**RIG)
    assert not bpy.data.armatures
