"""Live update: the form follows the options. (With a mouse: `make test-window`.)"""

import re
from time import sleep
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

from addon.blender.jobs.form_task import compute_on
from addon.blender.jobs.request import Request
from addon.blender.mesh_items.fingerprints import key_fingerprint
from addon.blender.records.record import require_record, write_record
from addon.blender.results.variants import VariantTask
from addon.core import KeptStages, Settings
from addon.core.posing.articulation import WORKED_ON
from addon.interface import main_panel
from addon.interface.job_operator import OBJECT_OT_canonical_form_cancel, kept_stages
from addon.interface.live_update import LiveUpdate, OBJECT_OT_canonical_form_live
from tests.blender.conftest import QUICK, add_object, drawn, snapshot
from tests.meshes import shapes


@pytest.fixture
def chosen(figure_object):
    """The choices in the panel, quick ones."""
    properties = bpy.context.object.canonical_form
    for name, value in QUICK.items():
        setattr(properties, name, value)
    return properties


def settle(live, seconds=60):
    """Look until nothing is under way any more."""
    for _ in range(int(seconds / 0.01)):
        live.look()
        if live._job is None:
            return live.state
        sleep(0.01)
    raise AssertionError("it does not settle")


def positions(obj):
    return np.array([point.co for point in obj.data.shape_keys.key_blocks["Canonical Form"].data])


def of_the_button(obj, **options):
    """The form that the operator computes on a copy."""
    other = obj.copy()
    other.data = obj.data.copy()
    bpy.context.collection.objects.link(other)
    with bpy.context.temp_override(object=other, active_object=other, selected_objects=[other]):
        bpy.ops.object.canonical_form(**QUICK, **options)
    form = positions(other)
    bpy.data.objects.remove(other)
    return form


def test_the_form_follows_the_options(figure_object, chosen):
    live = LiveUpdate(bpy.context)
    assert re.fullmatch(r"Live: \d+\.\d\d s", settle(live))
    first = positions(figure_object)
    assert np.array_equal(first, of_the_button(figure_object))
    key = figure_object.data.shape_keys.key_blocks["Canonical Form"]
    key.value = 0.25
    for options in ({"preserve_detail": 0.125}, {"preserve_detail": 0.125, "prominence": 0.0625}, {}):
        for name in ("preserve_detail", "prominence"):
            chosen.property_unset(name)
        for name, value in options.items():
            setattr(chosen, name, value)
        settle(live)
        assert np.array_equal(positions(figure_object), of_the_button(figure_object, **options)), options
        assert key.value == 0.25
    assert np.array_equal(positions(figure_object), first)


def test_a_form_that_is_there_stays_until_an_option_changes(figure_object, chosen):
    bpy.ops.object.canonical_form(**{**QUICK, "preserve_detail": 0.25})
    before = snapshot(figure_object)
    live = LiveUpdate(bpy.context)
    settle(live)
    assert snapshot(figure_object) == before
    other = add_object("Other", *shapes.figure(15))
    settle(live)
    bpy.context.view_layer.objects.active = other
    settle(live)
    assert other.data.shape_keys is None
    chosen.preserve_detail = 0.75  # of the first object
    other.canonical_form.preserve_detail = 0.75
    settle(live)
    assert snapshot(figure_object) == before
    assert other.data.shape_keys is not None


def test_a_change_stops_what_is_computed(figure_object, chosen):
    live = LiveUpdate(bpy.context)
    live.look()
    job = live._job
    assert job is not None
    chosen.preserve_detail = 0.25
    live.look()
    assert job.stopped or not job.running
    chosen.property_unset("preserve_detail")  # back where it was: computed all the same
    settle(live)
    assert np.array_equal(positions(figure_object), of_the_button(figure_object))


def test_it_waits_and_says_why(figure_object, chosen, monkeypatch):
    bpy.ops.object.mode_set(mode="EDIT")
    live = LiveUpdate(bpy.context)
    assert "Object Mode" in settle(live)
    bpy.ops.object.mode_set(mode="OBJECT")
    chosen.feature_points = "one, two"
    assert "vertex indices" in settle(live)
    assert figure_object.data.shape_keys is None
    chosen.feature_points = ""
    with monkeypatch.context() as other:
        other.setattr(OBJECT_OT_canonical_form_cancel, "job", SimpleNamespace(stop=lambda: None))
        settle(live)
        assert figure_object.data.shape_keys is None
    settle(live)
    assert figure_object.data.shape_keys is not None


def test_a_mesh_that_changes_meanwhile_is_not_written_to(figure_object, chosen):
    live = LiveUpdate(bpy.context)
    live.look()
    figure_object.data.vertices[0].co.x += 0.5
    assert "was edited" in settle(live)
    assert figure_object.data.shape_keys is None
    chosen.preserve_detail = 0.25
    settle(live)
    assert figure_object.data.shape_keys is not None


def test_the_button_starts_and_stops_it(figure_object, chosen, monkeypatch):
    with pytest.raises(RuntimeError, match="needs a window"):
        bpy.ops.object.canonical_form_live()
    kind = OBJECT_OT_canonical_form_live
    told: list[str] = []
    button: Any = SimpleNamespace(report=lambda kinds, sentence: told.append(sentence))
    window = SimpleNamespace(app=SimpleNamespace(background=False, timers=bpy.app.timers))
    monkeypatch.setattr("addon.interface.live_update.bpy", SimpleNamespace(**{**vars(bpy), **vars(window)}))
    chosen.result = "OBJECT"
    assert kind.execute(button, bpy.context) == {"CANCELLED"}
    assert "Set Written As to Shape Key" in told[0]
    chosen.result = "KEY"
    assert kind.execute(button, bpy.context) == {"FINISHED"}
    live = kind.running()
    assert live is not None
    assert any("Live" in line for line in drawn(main_panel.VIEW3D_PT_canonical_form))
    settle(live)
    timer = kind.timer
    assert kind.execute(button, bpy.context) == {"FINISHED"}
    assert kind.running() is None
    assert not bpy.app.timers.is_registered(timer)
    assert kind.execute(button, bpy.context) == {"FINISHED"}
    again = kind.running()
    assert again is not None
    again.look()
    monkeypatch.undo()
    bpy.ops.wm.read_homefile(use_empty=True)
    assert kind.running() is None
    assert kind.update is None


def test_sliders_stay_where_they_are(figure_object, chosen):
    other = add_object("Other", *shapes.figure(15))
    for obj, value in ((figure_object, 0.25), (other, 0.75)):
        bpy.context.view_layer.objects.active = obj
        bpy.ops.object.canonical_form(**QUICK, objects="EACH", value=value)
    for obj in (figure_object, other):
        obj.select_set(True)
    chosen.objects = "EACH"
    keys = [obj.data.shape_keys.key_blocks["Canonical Form"] for obj in (figure_object, other)]
    keys[0].value, keys[1].value = 0.25, 0.75
    live = LiveUpdate(bpy.context)
    chosen.preserve_detail = 0.125
    live.look()
    keys[0].value = 0.5  # while it computes
    settle(live)
    assert [key.value for key in keys] == [0.5, 0.75]


def test_what_is_cleared_or_computed_meanwhile_stays(figure_object, chosen):
    bpy.ops.object.canonical_form(**QUICK)
    live = LiveUpdate(bpy.context)
    chosen.preserve_detail = 0.125
    live.look()
    bpy.ops.object.canonical_form_clear()
    settle(live)
    assert figure_object.data.shape_keys is None
    bpy.ops.object.canonical_form(**QUICK, preserve_detail=0.75)
    whole = positions(figure_object)
    chosen.preserve_detail = 0.25
    live.look()
    bpy.ops.object.canonical_form_limb(patch=1)
    limb = positions(figure_object)
    assert not np.array_equal(limb, whole)
    settle(live)
    assert np.array_equal(positions(figure_object), limb)


def test_undo_brings_the_form_up_to_date_and_not_back(figure_object, chosen):
    live = LiveUpdate(bpy.context)
    settle(live)
    form = positions(figure_object)
    key = figure_object.data.shape_keys.key_blocks["Canonical Form"]
    key.data[0].co.x += 1.0  # as an undo step from before the last result would have it
    record = require_record(figure_object.data)
    record.keys[key.name] = key_fingerprint(key)
    write_record(figure_object.data, record)
    settle(live)
    assert not np.array_equal(positions(figure_object), form)
    live.undone(bpy.context)
    settle(live)
    assert np.array_equal(positions(figure_object), form)
    bpy.ops.object.canonical_form_clear()
    live.undone(bpy.context)
    settle(live)
    assert figure_object.data.shape_keys is None


def test_nothing_selected_in_between_does_not_make_it_forget(figure_object, chosen):
    bpy.ops.object.canonical_form(**QUICK)
    figure_object.select_set(False)
    other = add_object("Other", *shapes.figure(15))
    figure_object.select_set(False)
    bpy.ops.object.canonical_form(**QUICK)
    before = snapshot(other)
    other.select_set(False)
    bpy.context.view_layer.objects.active = figure_object
    live = LiveUpdate(bpy.context)
    settle(live)
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = None
    chosen.preserve_detail = 0.125
    settle(live)
    bpy.context.view_layer.objects.active = other
    settle(live)
    assert snapshot(other) == before


def test_an_error_that_nobody_expected_is_told(figure_object, chosen, monkeypatch, capsys):
    def broken(*_, **__):
        raise ValueError("oh")

    live = LiveUpdate(bpy.context)
    monkeypatch.setattr("addon.core.canonical.opened", broken)
    assert "error in the extension" in settle(live)
    assert "ValueError: oh" in capsys.readouterr().err


def test_a_limb_takes_the_coarse_mesh_of_the_form(blender, monkeypatch):
    vertices, faces = shapes.midpoints(*shapes.midpoints(*shapes.figure(13)))
    obj = add_object("Figure", vertices, faces)
    assert len(vertices) > 3 * WORKED_ON
    results = []
    for keep in (None, KeptStages()):
        compute_on(obj, Request(Settings(**QUICK), keep=keep))
        task = VariantTask(obj, limbs=[True, False, True, True, True], keep=keep)
        if keep is not None:
            monkeypatch.setattr("addon.core.surface.working_surface.coarsened", None)
        task.compute()
        task.write()
        results.append(snapshot(obj))
    assert results[0] == results[1]


def test_it_waits_where_any_selected_object_shows_a_pose(figure_object, chosen, arrays):
    posed = add_object("Posed", *arrays)
    bpy.ops.object.canonical_form_pose_like(pose="T", anyway=True, **QUICK)
    posed.select_set(True)
    figure_object.select_set(True)
    bpy.context.view_layer.objects.active = figure_object
    live = LiveUpdate(bpy.context)
    chosen.preserve_detail = 0.3
    assert "Posed shows another's pose" in settle(live)
    assert "T-Pose" in posed.data.shape_keys.key_blocks
    assert figure_object.data.shape_keys is None


def test_modifiers_that_change_the_vertices_add_no_objects(figure_object, chosen):
    figure_object.modifiers.new("Subdivision", "SUBSURF").levels = 1
    chosen.mesh = "SHOWN"
    live = LiveUpdate(bpy.context)
    for share in (0.3, 0.6):
        chosen.preserve_detail = share
        assert "Modifiers change the number of vertices of Figure" in settle(live)
    assert [obj.name for obj in bpy.data.objects] == ["Figure"]
    chosen.mesh = "BASE"
    assert re.match(r"Live: \d", settle(live))


def test_what_is_kept_is_of_the_objects_last_worked_on(figure_object, monkeypatch):
    assert kept_stages([figure_object]) is None  # in background
    monkeypatch.setattr("addon.interface.job_operator.bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    first = kept_stages([figure_object])
    assert kept_stages([figure_object]) is first
    other = add_object("Other", *shapes.figure(15))
    assert kept_stages([figure_object, other]) is not first
    assert kept_stages([other, figure_object]) is kept_stages([figure_object, other])
    assert OBJECT_OT_canonical_form_cancel.kept is not None
    monkeypatch.undo()
    bpy.ops.wm.read_homefile(use_empty=True)
    assert OBJECT_OT_canonical_form_cancel.kept is None


def test_several_objects_follow_as_one_body(character):
    properties = bpy.context.object.canonical_form
    for name, value in QUICK.items():
        setattr(properties, name, value)
    bpy.ops.object.canonical_form(objects="TOUCHING", **QUICK)
    live = LiveUpdate(bpy.context)
    before = {name: positions(obj) for name, obj in character.items()}
    properties.preserve_detail = 0.25
    settle(live)
    followed = {name: positions(obj) for name, obj in character.items()}
    assert all(not np.array_equal(followed[name], before[name]) for name in ("trunk", "shirt"))
    bpy.ops.object.canonical_form(objects="TOUCHING", **{**QUICK, "preserve_detail": 0.25})
    assert all(np.array_equal(followed[name], positions(obj)) for name, obj in character.items())


def limbs_of(obj):
    return require_record(obj.data).straightened


@pytest.mark.parametrize("keys", [0, 3])
def test_limbs_left_in_their_pose_stay_in_it(figure_object, chosen, keys):
    """An update keeps the choice of limbs, by where they end; the button takes the pose out of all."""
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_limb(patch=2, only=True)
    if keys:
        bpy.ops.object.canonical_form_in_betweens(count=keys)
    choice = [False, True, *[False] * (len(limbs_of(figure_object)) - 2)]
    live = LiveUpdate(bpy.context)
    chosen.preserve_detail = 0.125
    assert re.match(r"Live: \d", settle(live))
    assert limbs_of(figure_object) == choice
    updated = positions(figure_object)
    bpy.ops.object.canonical_form(**{**QUICK, "preserve_detail": 0.125})
    assert all(limbs_of(figure_object))
    assert np.ptp(updated - positions(figure_object), axis=0).max() > 0.1
    bpy.ops.object.canonical_form_limb(patch=2, only=True)
    assert np.allclose(updated, positions(figure_object), atol=1e-5)
