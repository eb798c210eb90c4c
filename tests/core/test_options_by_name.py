"""Options by name and as a dictionary, many meshes at once, and arrays of any number type."""

import inspect
from typing import Any

import numpy as np
import pytest

from addon import core
from addon.core import CanonicalForm, InvalidMeshError, InvalidSettingsError, Settings, canonical_form, canonical_forms
from addon.core.method_api.settings import AnySettings
from tests.meshes import shapes

QUICK: dict[str, Any] = {"landmark_count": 40, "quality": "draft"}
DOORS = ("canonical_form", "canonical_forms", "feature_patches", "find_contacts", "match", "pose_like", "rig",
         "stance_by_match")  # fmt: skip


@pytest.fixture(scope="module")
def figure():
    return shapes.figure(13)


@pytest.mark.parametrize("name", DOORS)
def test_every_door_with_settings_takes_options(name):
    parameters = inspect.signature(getattr(core, name)).parameters
    assert parameters["settings"].default is None
    assert parameters["settings"].annotation == "AnySettings"
    assert parameters["options"].kind is inspect.Parameter.VAR_KEYWORD
    assert AnySettings


def test_no_other_door_takes_settings():
    names = [name for name in core.__all__ if inspect.isfunction(getattr(core, name))]
    assert sorted(name for name in names if "settings" in inspect.signature(getattr(core, name)).parameters) == [*DOORS]


def test_the_three_ways_are_one(figure):
    forms = [
        canonical_form(figure[0], figure[1], Settings(**QUICK)),
        canonical_form(figure[0], figure[1], QUICK),
        canonical_form(*figure, **QUICK),
        canonical_form(figure[0], figure[1], {"quality": "normal", "landmark_count": 40}, quality="draft"),
        canonical_form(figure[0], figure[1], Settings(landmark_count=40), quality="draft"),
    ]
    for each in forms[1:]:
        np.testing.assert_array_equal(each.vertices, forms[0].vertices)


@pytest.mark.parametrize(
    ("settings", "options", "says"),
    [
        (None, {"qualty": "draft"}, "no option 'qualty'. Options: quality"),
        ({"symetry": "hold"}, {}, "no option 'symetry'. Options: symmetry"),
        (None, {"xyz": 1}, "no option 'xyz'. Options: method, quality"),
        (3, {}, "Options must be Settings, or a dictionary by name; got int"),
        (None, {"quality": "best"}, "quality"),
    ],
)
def test_what_is_wrong_is_said(figure, settings, options, says):
    with pytest.raises(InvalidSettingsError, match=says):
        canonical_form(figure[0], figure[1], settings, **options)
    with pytest.raises(InvalidSettingsError, match=says):
        canonical_forms([], settings, **options)  # before the first is asked for


@pytest.mark.parametrize("workers", [1, 2])
def test_many_meshes_are_computed_in_order_and_odd_ones_told(figure, workers):
    other = shapes.figure(14)
    meshes: Any = iter([figure, (figure[0], []), other, figure])
    found: list[Any] = list(canonical_forms(meshes, workers=workers, **QUICK))
    assert [type(each) for each in found] == [CanonicalForm, InvalidMeshError, CanonicalForm, CanonicalForm]
    assert found[1].kind == "no_faces"
    for each, mesh in ((found[0], figure), (found[2], other), (found[3], figure)):
        np.testing.assert_array_equal(each.vertices, canonical_form(*mesh, **QUICK).vertices)


def test_a_generator_is_read_as_far_as_the_work_has_come(figure):
    taken = []

    def meshes():
        for number in range(20):
            taken.append(number)
            yield figure

    forms = canonical_forms(meshes(), workers=1, **QUICK)
    next(forms)
    assert taken == [0]


@pytest.mark.parametrize("kind", [np.float32, list])
def test_any_numbers_are_taken_as_they_are(figure, kind):
    """A mesh in single precision gives what its values give in double precision."""
    vertices, faces = figure
    given = vertices.tolist() if kind is list else (100 * vertices).astype(kind)
    plain = np.asarray(given, dtype=np.float64)
    small = faces.tolist() if kind is list else faces.astype(np.uint16)
    with_kind, without = canonical_form(given, small, **QUICK), canonical_form(plain, faces, **QUICK)
    assert with_kind.vertices.dtype == np.float64
    np.testing.assert_array_equal(with_kind.vertices, without.vertices)
    matched = core.match(given, small, given, small, **QUICK)
    np.testing.assert_array_equal(matched.weights, core.match(plain, faces, plain, faces, **QUICK).weights)
    field = core.distance_field(given, small, [0])
    np.testing.assert_array_equal(field, core.distance_field(plain, faces, [0]))
