"""The record on a mesh: that of version 0.1 is read, and any other text is not taken for a record."""

import json
import random
from types import SimpleNamespace
from typing import Any

import bpy
import pytest

from addon.blender.mesh_items.fingerprints import colour_fingerprint, group_fingerprints, key_fingerprint
from addon.blender.records.distance_record import DISTANCES_PROPERTY, read_distances
from addon.blender.records.record import RECORD_PROPERTY, Record, read_record, require_record
from addon.blender.records.transfer_record import TRANSFERS_PROPERTY, read_transfers
from addon.interface import panels
from addon.interface.choices import hand_over
from addon.interface.overlay import shown_points
from addon.interface.properties import chosen_value, settings_of
from tests.blender.conftest import QUICK, drawn
from tests.blender.test_tools import select

WRITTEN: dict[str, Any] = {  # with a limb in its pose and in-betweens
    "palette": [[0.77, 0.2, 0.16], [0.0, 0.28, 0.31]],
    "hidden": {".canonical_form_patch": "e1", ".canonical_form": "e2"},
    "report": {
        "vertices": 1124,
        "faces": 2244,
        "feature_points": [1123, 997],
        "mends": {"One pair.": "LIMBS"},
        "feature_names": ["head", ""],
        "patch_sizes": [560, 564],
        "method": "local_features",
        "pieces": "apart",
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


def test_a_record_is_read_and_written_back_the_same():
    record = Record.from_json(json.loads(json.dumps(WRITTEN)))
    assert record.as_json() == WRITTEN
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
    report = {name: WRITTEN["report"][name] for name in ("vertices", "faces", "feature_points", "patch_sizes")}
    data = {
        "report": {**report, "timings": {}, "warnings": []},
        "before": WRITTEN["before"],
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
        *(json.dumps({**WRITTEN, **part}) for part in ({"report": 3}, {"before": {"other": 1}}, {"groups": 3})),
    ],
)
def test_another_text_is_no_record(figure_object, text):
    figure_object.data[RECORD_PROPERTY] = text
    assert read_record(figure_object.data) is None


def test_a_written_record_has_these_keys(figure_object):
    bpy.ops.object.canonical_form(**QUICK, method="local_features")
    bpy.ops.object.canonical_form_in_betweens(count=2)
    bpy.ops.object.canonical_form_limb(patch=1)
    data = json.loads(figure_object.data[RECORD_PROPERTY])
    assert data.keys() == WRITTEN.keys()
    assert data["report"].keys() == WRITTEN["report"].keys()
    assert data["before"].keys() == WRITTEN["before"].keys()


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


def users_own(obj):
    """What the user has of each kind, with what it holds."""
    mesh = obj.data
    keys = {} if mesh.shape_keys is None else {key.name: key_fingerprint(key) for key in mesh.shape_keys.key_blocks}
    colours = {each.name: colour_fingerprint(each) for each in mesh.color_attributes}
    others = [each.name for each in mesh.attributes if each.name not in colours and "canonical_form" not in each.name]
    return group_fingerprints(obj, dict.fromkeys(obj.vertex_groups.keys())), keys, colours, sorted(others)


@pytest.fixture
def painted_object(figure_object):
    """An object with something of the user's of each kind."""
    mesh = figure_object.data
    figure_object.vertex_groups.new(name="My Weights").add([0, 1, 2], 0.5, "REPLACE")
    figure_object.shape_key_add(name="Basis")
    figure_object.shape_key_add(name="My Sculpt").data[0].co.x += 1
    mesh.attributes.new("my_attribute", "FLOAT", "POINT")
    mesh.attributes.new("sharp_face", "BOOLEAN", "FACE")
    mesh.color_attributes.new("My Paint", "FLOAT_COLOR", "POINT").data[0].color = (1, 0, 1, 1)
    mesh.uv_layers.new(name="UVMap")
    return figure_object


MADE_UP: dict[str, Any] = {  # as a stranger may write it: everything of the user's is said to be ours
    "report": {"vertices": 1, "faces": 1, "feature_points": [], "patch_sizes": [], "timings": {}, "warnings": []},
    "before": {},
    "basis": "Basis",
    "groups": {"My Weights": None},
    "colours": {"My Paint": None},
    "hidden": dict.fromkeys(("my_attribute", "UVMap", "sharp_face", "position", ".corner_vert")),
}


def test_a_made_up_record_takes_nothing_of_the_users(painted_object):
    before = users_own(painted_object)
    for operator, options in ((bpy.ops.object.canonical_form_clear, {}), (bpy.ops.object.canonical_form, QUICK)):
        painted_object.data[RECORD_PROPERTY] = json.dumps({**MADE_UP, "key": {"My Sculpt": None}})
        assert read_record(painted_object.data) is not None
        assert operator(**options) == {"FINISHED"}
    warnings = require_record(painted_object.data).report.warnings
    assert any("My Sculpt, My Weights, My Paint" in warning for warning in warnings)
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert users_own(painted_object) == before


def test_a_spoilt_record_is_none_or_can_be_shown_and_cleared(painted_object):
    figure_object, before = painted_object, users_own(painted_object)
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
        shown_points([figure_object], bpy.context.evaluated_depsgraph_get())
        read += read_record(figure_object.data) is not None
    assert 20 < read < 300
    longer = json.dumps({**record, "more": "x" * 10**7})
    for text in ("[" * 100_000, json.dumps(record).replace("Patch 1", "\\ud800"), longer):
        figure_object.data[RECORD_PROPERTY] = text
        assert read_record(figure_object.data) is None
    figure_object.data[RECORD_PROPERTY] = json.dumps(record)
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert users_own(figure_object) == before


def test_clearing_by_a_spoilt_record_keeps_what_is_the_users(painted_object, tmp_path):
    before, rng, cleared = users_own(painted_object), random.Random(1), 0
    assert bpy.ops.object.canonical_form(**QUICK) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_in_betweens(count=2) == {"FINISHED"}
    record, path = json.loads(painted_object.data[RECORD_PROPERTY]), str(tmp_path / "painted.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    for _ in range(80):
        bpy.ops.wm.open_mainfile(filepath=path)
        obj = bpy.data.objects["Figure"]
        bpy.context.view_layer.objects.active = obj
        obj.data[RECORD_PROPERTY] = json.dumps(spoilt(record, rng))
        if read_record(obj.data) is None:
            continue
        assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
        cleared += 1
        for had, has in zip(before, users_own(obj), strict=True):
            assert set(had) <= set(has) if isinstance(had, list) else had.items() <= has.items()
    assert cleared > 5


def test_a_choice_that_this_version_has_not_is_the_default(figure_object):
    obj = bpy.context.object
    chosen, names = obj.canonical_form, ("method", "quality", "pieces", "mesh", "distance", "orientation")
    chosen.isolines = 3  # so that there is something stored
    known = {name: getattr(chosen, name) for name in names}
    stored = obj.bl_system_properties_get(do_create=True) if hasattr(obj, "bl_system_properties_get") else obj
    for name in names:
        stored["canonical_form"][name] = 99
    assert [getattr(chosen, name) for name in names] == [""] * len(names)
    assert {name: chosen_value(chosen, name) for name in names} == known
    for panel in panels.CLASSES:
        if issubclass(panel, bpy.types.Panel):
            drawn(panel)
    settings = settings_of(chosen)
    assert (settings.method, settings.quality, settings.pieces) == (known["method"], known["quality"], known["pieces"])
    handed = SimpleNamespace()
    hand_over(chosen, handed)
    assert (handed.method, handed.mesh) == (known["method"], known["mesh"])


@pytest.mark.parametrize("text", ["[" * 100_000, "[]", '{"groups": {"a": 3}}', '{"groups": {"a": "\\ud800"}}'])
def test_spoilt_records_of_distances_and_of_what_was_taken_over(figure_object, text):
    figure_object.data[DISTANCES_PROPERTY] = figure_object.data[TRANSFERS_PROPERTY] = text
    assert read_distances(figure_object.data) == {}
    assert not any(read_transfers(figure_object.data).values())
