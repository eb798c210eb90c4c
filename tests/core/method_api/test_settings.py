"""Settings: their ranges, what methods fix of them, and the names that version 0.1 gave them."""

import warnings
from dataclasses import fields, replace
from typing import Any

import pytest

from addon.core import InvalidSettingsError, Settings
from addon.core.method_api.options import options_of
from addon.core.method_api.settings import current_options

PUBLISHED: dict[str, Any] = {"as_published": True}


@pytest.mark.parametrize(
    "wrong",
    [{"diffusion_time": 0}, {"diffusion_time": 1000}, {"arrangement_share": float("inf")},
     {"eigenpairs": 0}, {"prominence": -1}, {"merge_distance": 2}, {"start": "pose"},
     {"landmark_count": 2}, {"arrangement_share": -1},
     {"smoothing": -1}, {"quality": "best"}, {"preserve_detail": 2},
     {"max_iterations": -1}, {"tolerance": -1}, {"extrapolation": -1},
     {"memory_limit": -1}, {"memory_limit": "1"}, {"eigenpairs": 2.5}, {"landmark_count": None}],
)  # fmt: skip
def test_settings_out_of_range_are_refused_by_name(wrong):
    with pytest.raises(InvalidSettingsError, match=next(iter(wrong))) as refused:
        Settings(**wrong)
    assert refused.value.kind == "setting_range"
    assert refused.value.numbers["name"] == next(iter(wrong))


def test_every_setting_says_what_it_is():
    assert list(options_of(Settings)) == [each.name for each in fields(Settings)]
    for name, about in options_of(Settings).items():
        assert about.label, name
        assert about.help, name
        default = getattr(Settings(), name)
        assert default is None or about.allows(default), name


@pytest.mark.parametrize(
    ("former", "value", "today"), [("landmarks", 50, "landmark_count"), ("iterations", 7, "max_iterations")]
)
def test_former_names_work_with_a_warning(former, value, today):
    with pytest.warns(FutureWarning, match=rf"{former} .*use {today}") as told:
        settings = Settings(**{former: value})
    assert settings == Settings(**{today: value})
    assert len(told) == 1
    with pytest.warns(FutureWarning, match=today):
        assert replace(settings, **{former: value + 1}) == Settings(**{today: value + 1})
    with pytest.warns(FutureWarning, match=today):
        assert current_options({former: value, "quality": "draft"}) == {today: value, "quality": "draft"}


@pytest.mark.filterwarnings("ignore::FutureWarning")
def test_unbending_is_forgotten_with_a_warning():
    with pytest.warns(FutureWarning, match="unbending .*straight without it"):
        assert Settings(**current_options({"unbending": 3.0})) == Settings()


@pytest.mark.parametrize("wrong", [{"landmarks": 2}, {"landmarks": None}, {"iterations": -1}, {"as_published": "no"}])
def test_values_under_former_names_are_refused_like_those_under_todays(wrong):
    today = {"landmarks": "landmark_count", "iterations": "max_iterations"}
    name = next(iter(wrong))
    with pytest.raises(InvalidSettingsError, match=today.get(name, name)):
        Settings(**wrong)


def test_the_warning_points_at_the_line_that_has_the_former_name():
    former: dict[str, Any] = {"landmarks": 50}
    with pytest.warns(FutureWarning) as told:
        Settings(**former)
    assert told[0].filename == __file__


def test_as_published_is_now_a_method():
    with pytest.warns(FutureWarning, match='as_published .*use method="as_published"'):
        assert Settings(**PUBLISHED) == Settings(method="as_published")
    with pytest.warns(FutureWarning):
        assert Settings(**(PUBLISHED | {"as_published": False})) == Settings()


def test_as_published_beside_another_method_is_as_published():
    """Up to version 0.1 the two were refused together."""
    for given in ({"method": "fast", **PUBLISHED}, {**PUBLISHED, "method": "fast"}):
        with pytest.warns(FutureWarning):
            assert Settings(**given).method == "as_published"
    with pytest.warns(FutureWarning):
        assert Settings(method="fast", **(PUBLISHED | {"as_published": False})).method == "fast"
    with pytest.warns(FutureWarning):
        assert replace(Settings(method="fast"), **PUBLISHED).method == "as_published"


def test_todays_names_are_taken_without_a_word():
    unknown: dict[str, Any] = {"marks": 50}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        settings = Settings(landmark_count=50, max_iterations=7, method="as_published")
        assert replace(settings, landmark_count=9).landmark_count == 9
    with pytest.raises(TypeError, match="unexpected keyword"):
        Settings(**unknown)
