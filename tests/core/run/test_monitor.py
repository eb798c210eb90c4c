"""Progress by weights, cancellation, timings and warnings."""

import warnings

import pytest

from addon.core import CancelledError
from addon.core.run.messages import message
from addon.core.run.monitor import Monitor

PLAN = {"Spectrum": 3, "Patches": 1, "Embedding": 4}


@pytest.fixture
def told():
    return []


@pytest.fixture
def monitor(told):
    return Monitor(lambda done, stage: told.append((done, stage)), plan=PLAN)


def test_stages_take_their_weight_of_the_whole(monitor, told):
    for name in PLAN:
        with monitor.stage(name):
            monitor.tick(0.5)
    assert told == [
        (0.0, "Spectrum"), (1.5 / 8, "Spectrum"), (3 / 8, "Spectrum"),
        (3 / 8, "Patches"), (3.5 / 8, "Patches"), (4 / 8, "Patches"),
        (4 / 8, "Embedding"), (6 / 8, "Embedding"), (1.0, "Embedding"),
    ]  # fmt: skip
    assert list(monitor.timings) == list(PLAN)


@pytest.mark.parametrize("scale", [1.0, 0.1, 7.3])
def test_weights_need_not_sum_to_anything(told, scale):
    monitor = Monitor(lambda done, stage: told.append(done), plan={name: scale * PLAN[name] for name in PLAN})
    for name in PLAN:
        with monitor.stage(name):
            pass
    assert told == pytest.approx([0, 3 / 8, 3 / 8, 4 / 8, 4 / 8, 1])


def test_a_stage_that_is_skipped_counts_as_done_when_the_next_begins(monitor, told):
    with monitor.stage("Spectrum"):
        pass
    with monitor.stage("Embedding"):
        pass
    assert [done for done, _ in told] == [0, 3 / 8, 4 / 8, 1]
    assert "Patches" not in monitor.timings


def test_a_stage_that_is_not_in_the_plan_is_part_of_the_one_around_it(monitor, told):
    with monitor.stage("Patches"):
        with monitor.stage("Cleaning"):
            monitor.tick(0.5)
        monitor.tick(0.75)
    assert told[1:-1] == [(3 / 8, "Cleaning"), (3.5 / 8, "Cleaning"), (4 / 8, "Cleaning"), (4 / 8, "Patches")]
    assert list(monitor.timings) == ["Cleaning", "Patches"]  # in the order of their ends


def test_without_a_plan_each_stage_is_the_whole_and_progress_stays(told):
    monitor = Monitor(lambda done, _: told.append(done))
    for name in ("One", "Two"):
        with monitor.stage(name):
            monitor.tick(0.5)
    assert told == [0, 0.5, 1, 1, 1, 1]


def test_progress_never_falls(monitor, told):
    with monitor.stage("Embedding"):
        monitor.tick(0.5)
        monitor.tick(0.1)
    with monitor.stage("Spectrum"):  # the order of the plan is not kept
        monitor.tick(0.5)
    done = [fraction for fraction, _ in told]
    assert done == sorted(done)
    assert max(done) == 1


def test_pieces_share_what_is_left_and_the_timings(monitor, told):
    with monitor.stage("Spectrum"):
        pass
    for begin, end in ((0.0, 0.25), (0.25, 1.0)):
        piece = monitor.piece(begin, end, {"Distances": 1, "Start": 3})
        for name in ("Distances", "Start"):
            with piece.stage(name):
                pass
        assert piece.timings is monitor.timings
    left = [3 / 8 + 5 / 8 * share for share in (0, 1 / 16, 1 / 16, 1 / 4, 1 / 4, 7 / 16, 7 / 16, 1)]
    assert [done for done, _ in told[2:]] == pytest.approx(left)
    assert [stage for _, stage in told[2:]] == 2 * ["Distances", "Distances", "Start", "Start"]
    assert list(monitor.timings) == ["Spectrum", "Distances", "Start"]


def test_a_stage_that_comes_again_adds_to_its_time(monitor, monkeypatch):
    clock = iter([0.0, 1.0, 10.0, 12.0])
    monkeypatch.setattr("addon.core.run.monitor.perf_counter", lambda: next(clock))
    for _ in range(2):
        with monitor.stage("Spectrum"):
            pass
    assert monitor.timings == {"Spectrum": 3.0}


def test_a_stage_that_fails_is_timed_and_left(monitor, told):
    with monitor.stage("Spectrum"):
        with pytest.raises(ZeroDivisionError), monitor.stage("Cleaning"):
            1 / 0  # noqa: B018
        monitor.tick(0.5)
    assert "Cleaning" in monitor.timings
    assert told[-2] == (1.5 / 8, "Spectrum")


def test_a_cancel_is_heard_at_every_tick_check_and_stage_also_of_a_piece():
    asked = [False]
    monitor = Monitor(cancelled=lambda: asked[0], plan=PLAN)
    piece = monitor.piece(0.0, 1.0, {})
    with monitor.stage("Spectrum"):
        monitor.tick(0.5)
    asked[0] = True
    for work in (monitor.check, piece.check, lambda: monitor.tick(0.6), lambda: piece.tick(0.6)):
        with pytest.raises(CancelledError) as stopped:
            work()
        assert stopped.value.kind == "cancelled"
    with pytest.raises(CancelledError), monitor.stage("Patches"):
        pytest.fail("the stage was entered")


def test_a_warning_comes_once():
    monitor = Monitor()
    monitor.warn("few_eigenpairs")
    monitor.warn("few_features", count=2)
    monitor.warn("few_eigenpairs")
    monitor.extend([message("few_features", count=2), message("few_features", count=3)])
    assert [each.kind for each in monitor.warnings] == ["few_eigenpairs", "few_features", "few_features"]
    assert [each.numbers for each in monitor.warnings] == [{}, {"count": 2}, {"count": 3}]


def test_a_piece_has_warnings_of_its_own():
    monitor = Monitor()
    piece = monitor.piece(0.0, 1.0, {})
    piece.warn("few_eigenpairs")
    assert [each.kind for each in piece.warnings] == ["few_eigenpairs"]
    assert monitor.warnings == []


def test_warnings_are_delivered_to_the_caller_or_as_pythons_own():
    monitor = Monitor()
    said: list[str] = []
    monitor.warn("few_eigenpairs")
    monitor.warn("few_features", count=2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        monitor.deliver(said.append)
    assert said == monitor.warnings
    with pytest.warns(UserWarning, match=r"fewer eigenpairs|has 2 feature points") as told:
        monitor.deliver(None)
    assert [str(each.message) for each in told] == monitor.warnings
