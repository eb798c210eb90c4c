"""Doubts and refusals have the buttons beside them that mend them, and one limb can be straightened at once."""

import bpy
import numpy as np
import pytest

from addon.blender.records.record import require_record
from addon.core import CanonicalFormError
from addon.core.run.messages import message
from addon.interface import main_panel, result_panel
from addon.interface.job_operator import JobOperator, OBJECT_OT_canonical_form_cancel, Refusal
from addon.interface.mending import limb_of_bone
from tests.blender.characters import activate
from tests.blender.conftest import QUICK, add_object, drawn
from tests.blender.rig_scenes import rigged_halves
from tests.meshes import shapes

MAIN, RESULT = main_panel.VIEW3D_PT_canonical_form, result_panel.VIEW3D_PT_canonical_form_result


@pytest.fixture(autouse=True)
def nothing_refused():
    yield
    OBJECT_OT_canonical_form_cancel.refused = None


def test_missing_limbs_are_offered_beside_the_warning(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    report = require_record(figure_object.data).report
    (sentence,) = report.mends
    assert report.mends[sentence] == "LIMBS"
    assert sentence in report.warnings
    missing = {"Head", "Left Hand", "Right Hand", "Left Foot", "Right Foot"} - {
        {"head": "Head", "left_hand": "Left Hand", "right_hand": "Right Hand", "left_foot": "Left Foot",
         "right_foot": "Right Foot"}.get(name) for name in report.feature_names}  # fmt: skip
    assert {*drawn(RESULT)} & ({*missing} or {"Add a Limb"})


@pytest.mark.parametrize(
    ("kind", "wish", "buttons"),
    [
        ("stance_unlikely", "RIG", {"Make Anyway", "Left Hand"}),
        ("handles", "FORM", {"Part Here"}),
        ("no_faces", "T", set()),
    ],
)
def test_a_refusal_stays_in_the_panel_with_what_mends_it(figure_object, monkeypatch, kind, wish, buttons):
    numbers = {"degrees": 40.0, "unlike": 0.1, "count": 2, "share": 0.5}
    told = message(kind, **numbers)

    def refuse(*_, **__):
        raise CanonicalFormError(told)

    before = {*drawn(MAIN)}
    monkeypatch.setattr("addon.blender.jobs.form_task.FormTask.compute", refuse)
    monkeypatch.setattr("addon.blender.rigging.rig_task.RigTask.compute", refuse)
    operator = {"RIG": "canonical_form_rig", "FORM": "canonical_form", "T": "canonical_form_pose_like"}[wish]
    with pytest.raises(RuntimeError):
        getattr(bpy.ops.object, operator)(**({"pose": "T"} if wish == "T" else {}))
    assert any(line.startswith(str(told)[:12]) for line in {*drawn(MAIN)} - before)
    assert buttons <= {*drawn(MAIN)}
    monkeypatch.undo()
    bpy.ops.object.canonical_form(**QUICK)
    assert OBJECT_OT_canonical_form_cancel.refused is None


def test_a_refusal_is_told_of_its_object_only(figure_object):
    OBJECT_OT_canonical_form_cancel.refused = Refusal("Another", "T", "Nothing was made.", "ANYWAY")
    assert "Make Anyway" not in drawn(MAIN)
    OBJECT_OT_canonical_form_cancel.refused = Refusal("Figure", "T", "Nothing was made.", "ANYWAY")
    assert {"Nothing was made.", "Make Anyway"} <= {*drawn(MAIN)}


@pytest.mark.parametrize(
    ("bone", "limb"),
    [
        ("hand.R", "right_hand"), ("mixamorig:LeftForeArm", "left_hand"), ("lowerarm_l", "left_hand"),
        ("thigh.L", "left_foot"), ("RightToeBase", "right_foot"), ("calf_twist", ""), ("head", ""), ("Spiral", ""),
    ],
)  # fmt: skip
def test_bones_tell_their_limbs(bone, limb):
    assert limb_of_bone(bone) == limb


def key_of(obj):
    return np.array([point.co for point in obj.data.shape_keys.key_blocks["Canonical Form"].data])


def test_one_limb_is_straightened_at_once(blender, lender):
    objects, _ = rigged_halves(lender)
    activate(*objects)
    how = {"mesh": "AUTO", "objects": "TOGETHER", **QUICK}
    bpy.ops.object.canonical_form(**how, limb="left_hand")
    record = require_record(objects[0].data)
    assert [name for name, out in zip(record.report.feature_names, record.straightened, strict=True) if out] == [
        "left_hand"
    ]
    alone = [key_of(obj) for obj in objects]
    bpy.ops.object.canonical_form(**how)
    assert all(require_record(objects[0].data).straightened)
    number = record.report.feature_names.index("left_hand") + 1
    bpy.ops.object.canonical_form_limb(patch=number, only=True)
    assert all(np.allclose(key_of(obj), each, atol=1e-4) for obj, each in zip(objects, alone, strict=True))


def test_a_limb_that_was_not_found_is_told_and_nothing_is_written(figure_object):
    with pytest.raises(RuntimeError, match=r"This limb was not found: Right Leg\."):
        bpy.ops.object.canonical_form(**QUICK, limb="right_foot")
    assert figure_object.data.shape_keys is None


def test_a_refusal_is_forgotten_with_its_file_and_is_of_the_object_that_was_meant(figure_object):
    from addon.interface.job_operator import _forget

    class Asked(JobOperator):
        def report(self, *_):
            pass

        def wish(self):
            return "T"

    asked = Asked()
    asked._begin(bpy.context)
    add_object("Other", *shapes.figure(12))
    asked._failed(CanonicalFormError("stance_limb"))
    assert OBJECT_OT_canonical_form_cancel.refused is not None
    assert OBJECT_OT_canonical_form_cancel.refused.owner == "Figure"
    assert "Make Anyway" not in drawn(MAIN)
    _forget()
    assert OBJECT_OT_canonical_form_cancel.refused is None
