"""The record on a mesh: that of version 0.1 is read, and any other text is not taken for a record."""

import json
import random
from typing import Any

import bpy
import pytest

from addon.blender.distance_record import DISTANCES_PROPERTY, read_distances
from addon.blender.record import RECORD_PROPERTY, Record, read_record
from addon.interface import panels
from addon.interface.overlay import feature_labels
from tests.blender.conftest import QUICK, drawn
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


ODD = [None, True, -1, 10**9, 10**400, 1e308, float("inf"), float("nan"), "", "x" * 1000, "\0", "{0}", [], [None], {},
       {"a": {"b": 1}}, [[1]], [-5], [10**12], ["x"]]  # fmt: skip


def places_in(value, path=()):
    """Every place in a JSON object, as the keys that lead there."""
    yield path
    for key, each in (
        value.items() if isinstance(value, dict) else enumerate(value[:6]) if isinstance(value, list) else ()
    ):
        yield from places_in(each, (*path, key))


def spoilt(record, rng):
    """A copy of a record with something else in one place, or nothing."""
    copy = json.loads(json.dumps(record))
    path = rng.choice([path for path in places_in(record) if path])
    owner = copy
    for key in path[:-1]:
        owner = owner[key]
    if rng.random() < 0.2:
        del owner[path[-1]]
    else:
        owner[path[-1]] = rng.choice(ODD)
    return copy


def test_a_spoilt_record_is_none_or_can_be_shown_and_cleared(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_limb(patch=1)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    record, rng = json.loads(figure_object.data[RECORD_PROPERTY]), random.Random(0)
    read = 0
    for _ in range(400):
        figure_object.data[RECORD_PROPERTY] = json.dumps(spoilt(record, rng))
        for panel in panels.CLASSES:
            if issubclass(panel, bpy.types.Panel):
                drawn(panel)
        feature_labels(figure_object, bpy.context.evaluated_depsgraph_get())
        read += read_record(figure_object.data) is not None
    assert 20 < read < 300
    figure_object.data[RECORD_PROPERTY] = "[" * 100_000
    assert read_record(figure_object.data) is None
    figure_object.data[RECORD_PROPERTY] = json.dumps(record)
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert figure_object.data.shape_keys is None
