"""Names of limbs: as the form tells, or as given by hand, and then the whole body follows them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from addon.core import InvalidSettingsError, Settings, canonical_form, mannequin, match, stance_by_match
from addon.core.surface.working_surface import working_surface
from addon.core.symmetry.limb_names import NAMES, mate_of, named_images, names_by_bones, side_of, with_names
from addon.core.symmetry.limbs import limbs_of

BODY = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0], [0.4, -3, 0]]) / 3
TOLD = ["left_hand", "right_hand", "left_foot", "right_foot", "head"]


def limbs_at(points):
    count = len(points)
    adf = np.array([2.0, 2, 2, 2, 1, 3])[:count]
    return limbs_of(cdist(points, points), np.zeros((count,) * 3), adf, lambda: np.arange(float(count)))


@pytest.fixture(scope="module")
def person():
    """A mannequin in its T-pose with few vertices, its form, and the points of its limbs by where they are."""
    vertices, faces = mannequin()
    small = working_surface(vertices, faces, 4000)
    points = vertices[small.kept]
    tips = [points[:, 2].argmax(), points[:, 0].argmax(), points[:, 0].argmin()]
    low = points[:, 2] < 0.1
    feet = [np.flatnonzero(low & (side * points[:, 0] > 0)) for side in (1, -1)]
    tips += [own[points[own, 1].argmin()] for own in feet]
    return points, small.faces, [int(each) for each in tips]


def test_a_form_tells_left_from_right(person):
    points, faces, tips = person
    form = canonical_form(points, faces)
    assert form.feature_names == ["head", *np.array(NAMES)[[1, 2, 3, 4]]]
    assert np.linalg.norm(points[form.feature_points] - points[tips], axis=1).max() < 0.15


def test_names_do_not_hang_on_the_orientation_of_the_form(person):
    points, faces, _ = person
    upright = canonical_form(points, faces, Settings(orientation="upright"))
    assert upright.feature_names == canonical_form(points, faces).feature_names
    assert upright.vertices[upright.feature_points[1], 0] > upright.vertices[upright.feature_points[2], 0]


def test_a_t_pose_stands_as_names_say(person):
    points, faces, tips = person
    names = list(NAMES[:5])
    asked = Settings(feature_points=tips, feature_names=names)
    found = stance_by_match(points, faces, asked, anyway=True)
    assert found.feature_names == names
    assert found.vertices[tips[1], 0] > 0.5 > -0.5 > found.vertices[tips[2], 0]
    other = replace(asked, feature_names=[mate_of(name) for name in names])
    swapped = stance_by_match(points, faces, other, anyway=True)
    assert swapped.vertices[tips[1], 0] < -0.5 < 0.5 < swapped.vertices[tips[2], 0]


def test_a_match_takes_what_has_one_name(person):
    points, faces, tips = person
    form = canonical_form(points, faces)
    asked = Settings(feature_points=form.feature_points.tolist(), feature_names=form.feature_names)
    found = match(points, faces, points, faces, asked)
    there = np.einsum("ij,ijk->ik", found.weights, points[faces[found.faces]])[tips[1:3]]
    assert len(found.sides) <= 2  # names of the other were not given, so its sides may be swapped
    assert np.linalg.norm(np.abs(there) - np.abs(points[tips[1:3]]), axis=1).max() < 0.2


def test_names_decide_head_and_sides():
    limbs = limbs_at(BODY[:5])
    upside_down = with_names(limbs, ["right_foot", "left_foot", "right_hand", "left_hand", ""])
    assert upside_down.side.tolist() == [-1, 1, -1, 1, 0]
    assert upside_down.along.tolist() == [0.5, 0.5, -0.5, -0.5, 0]  # without a head, from feet to hands
    named = with_names(limbs, TOLD)
    assert named.partner.tolist() == [1, 0, 3, 2, 4]
    assert named.along.tolist() == [0, 0, 0, 0, -1]


def test_a_named_limb_leaves_a_pair_that_is_none():
    limbs = limbs_at(BODY)._replace(partner=np.array([1, 0, 5, 3, 4, 2]), side=np.array([1, -1, 1, 0, 0, -1]))
    named = with_names(limbs, ["", "", "left_foot", "right_foot", "", ""])
    assert named.partner.tolist() == [1, 0, 3, 2, 4, 5]
    assert named.side.tolist() == [1, -1, 1, -1, 0, 0]


def test_one_name_turns_the_sides_of_all():
    limbs = limbs_at(BODY[:5])
    named = with_names(limbs, ["right_hand", "left_hand", "", "", ""])
    assert named.side.tolist() == (-limbs.side).tolist()


@pytest.mark.parametrize(("point", "name"), [(0, "left_hand"), (0, "right_hand"), (1, "left_hand"), (2, "right_foot")])
def test_one_name_alone_keeps_the_pair_and_tells_its_sides(point, name):
    limbs = limbs_at(BODY[:5])
    named = with_names(limbs, [name if number == point else "" for number in range(5)])
    assert named.partner.tolist() == limbs.partner.tolist()
    assert named.side[point] == side_of(name) == -named.side[named.partner[point]]


def test_names_are_sorted_with_their_points():
    named = with_names(limbs_at(BODY[:5]), TOLD)
    assert named.sorted_by(np.array([4, 0, 1, 2, 3])).named == ("head", *TOLD[:4])


def test_images_may_be_swapped_where_the_other_was_not_named():
    other = limbs_at(BODY[:5])
    one = with_names(other, TOLD)
    assert [image.tolist() for image in named_images(one, other)] == [[0, 1, 2, 3, 4], [1, 0, 3, 2, 4]]
    assert [image.tolist() for image in named_images(one, one)] == [[0, 1, 2, 3, 4]]
    assert [image.tolist() for image in named_images(other, one)] == [[-1] * 5]


def test_bones_name_each_limb_once():
    assert names_by_bones(["hand.R", "forearm.R", "thigh.L"]) == ["right_hand", "", ""]
    assert [side_of(name) for name in NAMES] == [0, 1, -1, 1, -1, 0]


@pytest.mark.parametrize(
    ("names", "kind"),
    [
        (["head"], "feature_names"),
        (["head", "nose"], "feature_names"),
        ("head", "feature_names"),
        ([3, 4], "feature_names"),
        (["head", "head"], "feature_name_twice"),
    ],
)
def test_wrong_names_are_refused(names, kind):
    with pytest.raises(InvalidSettingsError) as refused:
        Settings(feature_points=[1, 2], feature_names=names)
    assert refused.value.kind == kind


def test_names_without_points_are_refused():
    with pytest.raises(InvalidSettingsError):
        Settings(feature_names=["head"])
    assert Settings(feature_points=[1], feature_names=["head"]).detecting() == Settings()
