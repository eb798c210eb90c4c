"""The record on a mesh: that of version 0.1 is read, and any other text is not taken for a record."""

import json
from typing import Any

import bpy
import pytest

from addon.blender.distance_record import DISTANCES_PROPERTY, read_distances
from addon.blender.record import RECORD_PROPERTY, Record, read_record
from tests.blender.conftest import QUICK
from tests.blender.test_tools import select

VERSION_0_1: dict[str, Any] = {  # as that version wrote it, with a limb in its pose and in-betweens
    "palette": [[0.77, 0.2, 0.16], [0.0, 0.28, 0.31]],
    "hidden": {".canonical_form_patch": "e1", ".canonical_form": "e2"},
    "report": {
        "vertices": 1124,
        "faces": 2244,
        "feature_points": [1123, 997],
        "patch_sizes": [560, 564],
        "method": "local_features",
        "stress": {"first": 5086.5, "last": 1992.25, "steps": 3},
        "pair_count": 345247,
        "pair_reduction": 0.7267,
        "measures": {
            "compactness": None,
            "compactness_error": None,
            "edge_distortion_median": 0.03,
            "edge_distortion_95": 0.14,
        },
        "timings": {"Surface": 0.25, "Detail": 0.5},
        "warnings": ["The minimisation stopped after 3 steps before it converged."],
    },
    "before": {"shape_key": None, "group": "Arm", "colour": None, "render_colour": None},
    "basis": "Basis",
    "key": {"Canonical Form": "f0"},
    "groups": {"Feature Points": "a0", "Patch 1": "a1", "Patch 2": None},
    "colours": {"Auto Diffusion Function": "c0", "Patches": "c1"},
    "basis_print": "b0",
    "limbs": [False, True],
    "between": {"Canonical Form 33%": "f1", "Canonical Form 67%": "f2"},
    "animated_before": False,
    "value": 1.0,
}


def test_a_record_of_version_0_1_is_read_and_written_back_the_same():
    record = Record.from_json(json.loads(json.dumps(VERSION_0_1)))
    assert record.as_json() == VERSION_0_1
    assert record.has_form
    assert record.has_patches
    assert record.patch_names == ["Patch 1", "Patch 2"]
    assert record.patch_count == 2
    assert record.straightened == [False, True]
    assert list(record.in_between_keys) == ["Canonical Form 33%", "Canonical Form 67%"]
    assert record.active_before.group == "Arm"
    assert record.report.seconds == 0.75
    assert record.report.stress is not None
    assert record.report.stress.steps == 3


def test_a_record_of_feature_points_alone():
    report = {name: VERSION_0_1["report"][name] for name in ("vertices", "faces", "feature_points", "patch_sizes")}
    data = {
        "report": {**report, "timings": {}, "warnings": []},
        "before": VERSION_0_1["before"],
        "basis": None,
        "key": {},
        "groups": {"Feature Points": "a0"},
        "colours": {"Auto Diffusion Function": "c0"},
    }
    record = Record.from_json(data)
    assert record.as_json() == {**data, "hidden": {}, "palette": []}
    assert not record.has_form
    assert not record.has_patches
    assert not record.report.has_form
    assert record.patch_names == record.straightened == []


@pytest.mark.parametrize(
    "text",
    [
        *("", "{", "[]", "3", '"x"', "{}"),
        *(json.dumps({**VERSION_0_1, **part}) for part in ({"report": 3}, {"before": {"other": 1}}, {"groups": 3})),
    ],
)
def test_another_text_is_no_record(figure_object, text):
    figure_object.data[RECORD_PROPERTY] = text
    assert read_record(figure_object.data) is None


def test_a_written_record_has_the_keys_of_version_0_1(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    bpy.ops.object.canonical_form_limb(patch=1)
    data = json.loads(figure_object.data[RECORD_PROPERTY])
    assert data.keys() == VERSION_0_1.keys()
    assert data["report"].keys() == {*VERSION_0_1["report"].keys(), "pieces"}
    assert data["before"].keys() == VERSION_0_1["before"].keys()


@pytest.mark.parametrize("value", ["mine", "[1]", '{"Heat Geodesic colours": ["a"]}', 3])
def test_a_property_of_the_users_is_not_taken_for_distances(figure_object, value):
    figure_object.data[DISTANCES_PROPERTY] = value
    assert read_distances(figure_object.data) == {}
    select(figure_object, {10})
    assert bpy.ops.object.canonical_form_distance(kind="heat") == {"FINISHED"}
    assert list(read_distances(figure_object.data)) == ["Heat Geodesic"]
