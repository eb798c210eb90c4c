"""What is kept between runs: the same results to the bit, and nothing stale."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from addon.core import CancelledError, KeptStages, Settings, canonical_form
from addon.core.run.messages import Message, message
from tests.meshes import pieced, shapes

QUICK = Settings(landmark_count=20)
CHANGES: tuple[dict[str, Any], ...] = (
    {},
    {"preserve_detail": 0.2},
    {"preserve_detail": 0.0},
    {"prominence": 0.05},
    {"feature_count": 3},
    {"feature_points": (5, 40, 200)},
    {"feature_points": [5, 40, 201]},
    {"diffusion_time": 0.05},
    {"quality": "draft"},
    {"quality": "full"},
    {"method": "local_features", "max_iterations": 5},
    {"eigenpairs": 30},
    {"method": "local_features", "max_iterations": 5, "preserve_detail": 0.2},
    {"method": "local_features", "max_iterations": 2},
    {"landmark_count": 15},
    {"symmetry": "ignore"},
    {"symmetry": "ignore", "preserve_detail": 0.2},
    {"pieces": "apart"},
    {"orientation": "upright"},
    {"method": "classical"},
    {"method": "as_published"},
    {},
)


def character():
    """Several pieces."""
    made = pieced.character()[2]
    return made.vertices, made.faces


def assert_same(form, other):
    assert np.array_equal(form.vertices, other.vertices)
    assert np.array_equal(form.patches, other.patches)
    assert np.array_equal(form.feature_points, other.feature_points)
    assert np.array_equal(form.adf, other.adf)
    assert np.array_equal(form.stress, other.stress)
    assert form.pair_count == other.pair_count
    assert form.warnings == other.warnings


@pytest.mark.parametrize(
    ("mesh", "changes"),
    [(shapes.figure(11), CHANGES), (character(), CHANGES[::6])],
    ids=["figure", "pieces"],
)
def test_whatever_changes_the_result_is_that_of_a_run_of_its_own(mesh, changes):
    vertices, faces = mesh
    keep = KeptStages()
    for change in changes:
        settings = replace(QUICK, **change)
        assert_same(canonical_form(vertices, faces, settings, keep=keep), canonical_form(vertices, faces, settings))


def test_an_array_that_is_changed_in_place_is_another_mesh():
    vertices, faces = shapes.figure(13)
    keep = KeptStages()
    canonical_form(vertices, faces, QUICK, keep=keep)
    vertices[:, 0] *= 1.1
    assert_same(canonical_form(vertices, faces, QUICK, keep=keep), canonical_form(vertices, faces, QUICK))
    faces = faces[:-1]
    assert_same(canonical_form(vertices, faces, QUICK, keep=keep), canonical_form(vertices, faces, QUICK))


def test_a_change_of_what_rides_on_a_body_counts():
    made = pieced.character()[2]
    vertices, faces = made.vertices, made.faces
    keep = KeptStages()
    canonical_form(vertices, faces, QUICK, keep=keep)
    for name in ("shirt", "hand", "eye"):
        own = made.pieces[name]
        changed = vertices.copy()
        changed[own] += 0.05 * (vertices[own] - vertices[own].mean(axis=0))
        assert_same(canonical_form(changed, faces, QUICK, keep=keep), canonical_form(changed, faces, QUICK))


def test_arrays_of_any_kind_are_told_by_content():
    vertices, faces = shapes.figure(13)
    keep = KeptStages()
    given = vertices.copy()
    canonical_form(given, faces, QUICK, keep=keep)
    given *= 1.5  # what is kept has arrays of its own
    assert_same(canonical_form(vertices.copy(), faces, QUICK, keep=keep), canonical_form(vertices, faces, QUICK))

    class Wrapped:
        def __init__(self) -> None:
            self.array = vertices.copy()

        def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
            return self.array

    wrapped: Any = Wrapped()
    canonical_form(wrapped, faces, QUICK, keep=keep)
    wrapped.array[:, 0] *= 1.1
    assert_same(canonical_form(wrapped, faces, QUICK, keep=keep), canonical_form(wrapped, faces, QUICK))
    rows = tuple(map(tuple, vertices))
    assert_same(canonical_form(rows, faces, QUICK, keep=keep), canonical_form(vertices, faces, QUICK))


def test_what_is_kept_is_not_changed_by_its_users():
    vertices, faces = shapes.figure(13)
    keep = KeptStages()
    first = canonical_form(vertices, faces, QUICK, keep=keep)
    for array in (first.vertices, first.patches, first.adf, first.feature_points, first.stress):
        array[:] = 0
    assert_same(canonical_form(vertices, faces, QUICK, keep=keep), canonical_form(vertices, faces, QUICK))


def test_a_cancelled_run_leaves_nothing_half_done():
    vertices, faces = shapes.figure(13)
    keep, alone = KeptStages(), canonical_form(vertices, faces, QUICK)
    for polls in (3, 10, 30, 60, 100):
        asked: list[None] = []

        def cancelled(asked: list[None] = asked, polls: int = polls) -> bool:
            asked.append(None)
            return len(asked) > polls

        with pytest.raises(CancelledError):
            canonical_form(vertices, faces, QUICK, keep=keep, cancelled=cancelled)
    assert_same(canonical_form(vertices, faces, QUICK, keep=keep), alone)


def test_what_a_later_cancelled_run_found_can_be_used(monkeypatch):
    monkeypatch.setattr("addon.core.distances.heat._AT_ONCE", 1)  # looks at the monitor for every source
    vertices, faces = shapes.figure(13)
    keep = KeptStages()
    stop: list[bool] = []
    canonical_form(vertices, faces, QUICK, keep=keep, cancelled=lambda: bool(stop))
    stop.append(True)
    for change in CHANGES:
        canonical_form(vertices, faces, replace(QUICK, **change), keep=keep)


def test_only_what_depends_on_a_change_is_computed_again():
    vertices, faces = shapes.figure(13)
    keep = KeptStages()
    canonical_form(vertices, faces, QUICK, keep=keep)
    stages = canonical_form(vertices, faces, replace(QUICK, preserve_detail=0.3), keep=keep).timings
    assert "Detail" in stages
    assert not {"Spectrum", "Patches", "Struts", "Landmarks", "Layout", "Push", "Lengths"} & stages.keys()
    stages = canonical_form(vertices, faces, replace(QUICK, landmark_count=15), keep=keep).timings
    assert {"Landmarks", "Layout", "Push", "Lengths"} <= stages.keys()
    assert not {"Spectrum", "Patches", "Struts"} & stages.keys()


def test_warnings_come_with_what_is_kept():
    keep = KeptStages()
    told: list[int] = []
    for _ in range(2):
        warnings: list[Message] = []

        def compute(warnings: list[Message] = warnings) -> None:
            warnings.append(message("few_eigenpairs"))
            told.append(1)

        keep.take("stage", [1.0], compute, warnings)
        assert [each.kind for each in warnings] == ["few_eigenpairs"]
    assert len(told) == 1


def test_only_the_last_few_results_are_kept():
    keep, computed = KeptStages(), []

    def take(number):
        keep.take("stage", [number], lambda: computed.append(number), [])

    for number in (1, 2, 3, 1, 2, 3, 4, 1):
        take(number)
    assert computed == [1, 2, 3, 4, 1]
    take(True)  # of another type than 1
    assert computed[-1] is True


def test_what_is_full_keeps_no_more():
    kept, calls = KeptStages(), []

    def computed(value):
        calls.append(value)
        return [value]

    first = kept.take("Stage", [1], lambda: computed(1), [])
    kept.part("Body").take("Stage", [1], lambda: computed(2), [])
    kept.fill()
    assert kept.take("Stage", [1], lambda: computed(3), []) is first
    assert kept.part("Body").take("Stage", [1], lambda: computed(4), []) == [2]
    for part in (kept, kept.part("Body"), kept.part("Other")):
        for _ in range(2):
            part.take("Another", [1], lambda: computed(5), [])
    assert calls == [1, 2, 5, 5, 5, 5, 5, 5]
