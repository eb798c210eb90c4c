"""Left and right by distances on the surface and by toes, and what both together tell."""

import numpy as np
import pytest

from addon.core import Settings, mannequin, pose_like
from addon.core.assembly.opening import OPENING
from addon.core.assembly.unfolded_bodies import unfolded_bodies
from addon.core.run.monitor import Monitor
from addon.core.symmetry.chirality import sided
from addon.core.symmetry.limbs import TOLD_WEAKLY
from addon.core.symmetry.upright import SURELY, facing, upright_rotation


@pytest.fixture(scope="module")
def body():
    """A person, unfolded: front and back are told by toes."""
    return unfolded_bodies(*mannequin(), Settings(), Monitor().piece(0.0, 1.0, OPENING))[1][0]


def swapped(limbs):
    """The same limbs with left taken for right."""
    return limbs._replace(side=-limbs.side)


def with_told(limbs, told):
    """The same limbs as if distances told left from right by so much."""
    return limbs._replace(handedness=limbs.handedness * told / limbs.told)


def test_toes_tell_left_from_right(body):
    assert facing(body.form, body.areas, body.limbs) == body.facing
    assert abs(body.facing) > 1.5
    other = facing(body.form, body.areas, swapped(body.limbs))
    toes = (body.facing - other) / 2  # distances tell the same amount of either
    assert other == pytest.approx(body.limbs.told - toes)


def test_what_distances_tell_surely_no_toes_gainsay(body):
    sure = with_told(body.limbs, SURELY + 1)
    assert facing(body.form, body.areas, sure) == facing(body.form, body.areas, swapped(sure)) == sure.told


def test_names_by_hand_leave_no_doubt(body):
    assert facing(body.form, body.areas, body.limbs._replace(named=("head",))) == np.inf


@pytest.mark.parametrize(("told", "turned"), [(0.5, True), (1.1, True), (SURELY - 0.1, False)])
def test_a_body_stands_as_its_toes_say_if_distances_hardly_tell(body, told, turned):
    """Handedness just above the threshold was wrong on one of twenty scanned people, whose toes were right."""
    limbs = body.limbs if body.facing > 0 else swapped(body.limbs)
    right, wrong = (
        upright_rotation(body.form, body.areas, with_told(each, told), None)[0] for each in (limbs, swapped(limbs))
    )
    front = float(right[:, 1] @ wrong[:, 1])  # where the scene's axis from the front to the back lies in the form
    assert (front > 0.9) == turned
    assert (front < -0.9) != turned


def test_left_and_right_of_two_bodies_agree(body):
    """A body, and one with longer and thicker arms: the likeliest match takes left for left."""
    from addon.core.matching.sides import sides

    vertices, faces = mannequin()
    longer = vertices * np.where(np.abs(vertices[:, :1]) > 0.25, [1.4, 1.2, 1.2], 1.0)
    other = unfolded_bodies(longer, faces, Settings(), Monitor().piece(0.0, 1.0, OPENING))[1][0]
    ways = sides(body, other, Monitor())
    assert ways[0].facing > 1.0
    assert min(way.facing for way in ways) < -1.0


@pytest.mark.parametrize("told", [0.99, 1.01])
def test_threshold_is_that_of_limbs(body, told):
    limbs = with_told(body.limbs, told)
    assert limbs.told == pytest.approx(told)
    assert abs(sided(limbs.handedness, limbs.side, limbs.along)) == pytest.approx(told * TOLD_WEAKLY)
    assert limbs.tell_sides == (told >= 1)
    assert TOLD_WEAKLY < 0.05


@pytest.mark.parametrize("turned", [False, True])
def test_names_in_a_pose_follow_the_toes_and_not_the_order_of_the_vertices(turned):
    vertices, faces = mannequin()
    order = np.arange(len(vertices))[:: -1 if turned else 1]
    place = np.argsort(order)
    posed = pose_like(vertices[order], place[faces], *mannequin(40.0))
    at = dict(zip(posed.feature_names, vertices[order][posed.feature_points, 0], strict=True))
    assert at["left_hand"] > 0.5 > -0.5 > at["right_hand"]  # it faces -Y
    assert at["left_foot"] > 0 > at["right_foot"]
