"""Settings: their ranges, and what methods fix of them."""

from dataclasses import fields, replace
from typing import Any

import pytest

from addon.core import InvalidSettingsError, Settings
from addon.core.method_api.catalogue import methods
from addon.core.method_api.options import options_of

MARKS = {"part_here": None, "keep_joined": None}.keys()  # of a mesh, no options


@pytest.mark.parametrize(
    "wrong",
    [{"diffusion_time": 0}, {"diffusion_time": 1000}, {"eigenpairs": 0},
     {"prominence": -1}, {"feature_count": -1}, {"symmetry": "none"}, {"orientation": "down"},
     {"landmark_count": 2}, {"preserve_detail": float("inf")}, {"quality": "best"}, {"preserve_detail": 2},
     {"max_iterations": -1}, {"memory_limit": -1}, {"memory_limit": "1"}, {"max_iterations": 2.5},
     {"landmark_count": None}],
)  # fmt: skip
def test_settings_out_of_range_are_refused_by_name(wrong):
    with pytest.raises(InvalidSettingsError, match=next(iter(wrong))) as refused:
        Settings(**wrong)
    assert refused.value.kind == "setting_range"
    assert refused.value.numbers["name"] == next(iter(wrong))


def test_every_setting_says_what_it_is():
    assert [*options_of(Settings), *MARKS] == sorted((each.name for each in fields(Settings)), key=MARKS.__contains__)
    for name, about in options_of(Settings).items():
        assert about.label, name
        assert about.help, name
        default = getattr(Settings(), name)
        assert default is None or about.allows(default), name


def test_what_a_method_fixes_takes_the_place_of_what_is_wished():
    letter = methods()["as_published"].settings(Settings(quality="draft", max_iterations=7))
    assert (letter.quality, letter.max_iterations) == ("full", 7)
    wished = Settings(quality="draft")
    assert methods()["straight"].settings(wished) is wished


def test_every_option_is_of_a_method_or_of_all():
    of_all = {"method", "quality", "feature_points", "feature_names", "prominence", "feature_count", "diffusion_time",
              "eigenpairs", "orientation", "contacts", "pieces", "memory_limit"}  # fmt: skip
    used = {name for each in methods().values() for name in each.uses}
    assert used | of_all | MARKS == {each.name for each in fields(Settings)}


def test_an_unknown_name_is_refused():
    unknown: dict[str, Any] = {"marks": 50}
    with pytest.raises(TypeError, match="unexpected keyword"):
        Settings(**unknown)
    assert replace(Settings(landmark_count=50), landmark_count=9).landmark_count == 9
