"""Head, tail, left and right, and numbers that last."""

from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from addon.core import Settings, feature_patches
from addon.core.mesh.coarsening import coarsened
from addon.core.symmetry.limbs import lasting_order, limbs_of
from tests.meshes import shapes

POSES = {
    "man": ("rest", "dance1_00", "zombieWalk1_10"),
    "horse": ("bind", "horse_gallop_f00", "horse_death_02_f22"),
    "bear": ("bind", "bear_run_f12", "bear_walk_f18"),
}
# left is where the outside, the head and the front or belly say: along x, in the rest poses of these bodies
LEFT = {"man": 1, "horse": -1, "bear": -1}
HEAD = {"man": [0, 1, 0], "horse": [0, 0, -1], "bear": [0, 0, -1]}


def number_of_each(points, places):
    """For every place the number of the feature point nearest to it."""
    return cdist(places, points).argmin(axis=1).tolist()


@pytest.mark.parametrize("body", POSES)
def test_alike_limbs_have_alike_numbers_in_all_poses(body, real_mesh):
    meshes = [real_mesh(f"{body}/{pose}.obj") for pose in POSES[body]]
    rest = meshes[0][0]
    found = [feature_patches(*mesh).feature_points for mesh in meshes]
    places = rest[found[0]]
    for one, other in combinations(found, 2):
        assert number_of_each(rest[one], places) == number_of_each(rest[other], places)


@pytest.mark.parametrize("body", POSES)
def test_the_head_comes_first_and_left_before_right(body, real_mesh):
    rest, faces = real_mesh(f"{body}/{POSES[body][0]}.obj")
    tips = rest[feature_patches(rest, faces).feature_points]
    assert np.argmax((tips - rest.mean(axis=0)) @ HEAD[body]) in ((0, 1, 2) if body == "man" else (0,))
    across = np.sign(tips[:, 0] - rest[:, 0].mean()) * (np.abs(tips[:, 0]) > 0.05 * np.ptp(rest[:, 0]))
    middle = len(tips) - 4
    assert (across[middle:] == LEFT[body] * np.array([1, -1, 1, -1])).all()


def test_numbers_do_not_hang_on_the_order_of_the_vertices(real_mesh):
    vertices, faces = real_mesh("bear/bear_run_f12.obj")
    order = np.random.default_rng(3).permutation(len(vertices))
    place = np.argsort(order)
    plain = vertices[feature_patches(vertices, faces).feature_points]
    shuffled = vertices[order][feature_patches(vertices[order], place[faces]).feature_points]
    assert number_of_each(shuffled, plain) == [0, 1, 2, 3, 4]


def test_numbers_do_not_hang_on_the_mesh(real_mesh):
    vertices, faces = real_mesh("man/dance1_00.obj")
    plain = vertices[feature_patches(vertices, faces).feature_points]
    coarse = coarsened(vertices, faces, 6000)
    fewer = vertices[coarse.kept][feature_patches(vertices[coarse.kept], coarse.faces).feature_points]
    assert number_of_each(fewer, plain) == [0, 1, 2, 3, 4]


def test_a_mirrored_body_has_left_and_right_exchanged(real_mesh):
    vertices, faces = real_mesh("horse/horse_gallop_f00.obj")
    plain = vertices[feature_patches(vertices, faces).feature_points]
    mirrored = vertices[feature_patches(vertices * [-1, 1, 1], faces[:, ::-1]).feature_points]
    assert number_of_each(mirrored, plain) == [0, 1, 3, 2, 5, 4]


def test_where_nothing_tells_left_from_right_the_order_of_vertices_does():
    body = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0]]) / 3
    distances, adf, flat = cdist(body, body), np.array([2.0, 2, 2, 2, 1]), np.zeros((5, 5, 5))
    assert limbs_of(distances, flat, adf, lambda: np.array([5.0, 6, 7, 8, 9])).side.tolist() == [1, -1, 1, -1, 0]
    assert limbs_of(distances, flat, adf, lambda: np.array([6.0, 5, 8, 7, 9])).side.tolist() == [-1, 1, -1, 1, 0]


def test_without_left_and_right_the_most_prominent_come_first_and_ties_go_by_vertex():
    line = np.array([[0.0], [3], [10], [25]])
    vertices = np.array([9, 4, 1, 2])
    alone = limbs_of(cdist(line, line), np.zeros((4, 4, 4)), np.array([1.0, 3, 9, 27]), lambda: vertices)
    assert not alone.side.any()
    assert lasting_order(alone, np.array([2.02, 2.0, 0.7, 3.0]), vertices).tolist() == [3, 1, 0, 2]


def test_feature_points_chosen_by_hand_keep_their_order(real_mesh):
    vertices, faces = real_mesh("bear/bind.obj")
    found = feature_patches(vertices, faces).feature_points
    backwards = tuple(int(each) for each in found[::-1])
    given = feature_patches(vertices, faces, Settings(feature_points=backwards)).feature_points
    assert tuple(given) == backwards


def test_limbs_of_a_star_are_told_apart_in_no_time():
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    star = np.column_stack([np.cos(angle), np.sin(angle)])
    limbs = limbs_of(cdist(star, star), np.zeros((60, 60, 60)), np.ones(60), lambda: np.arange(60.0))
    assert (limbs.partner == np.arange(60)).all()


def test_a_tube_has_two_ends():
    assert len(feature_patches(*shapes.joint(60)).feature_points) == 2


def test_joined_parts_need_more_to_tell_left_from_right():
    body = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0]]) / 3
    weak = np.zeros((5, 5, 5))
    for turn in range(3):
        i, j, k = np.roll((0, 4, 1), turn)
        weak[i, j, k], weak[i, k, j] = 0.01, -0.01  # 1 is the left hand
    distances, adf = cdist(body, body), np.array([2.0, 2, 2, 2, 1])
    assert limbs_of(distances, weak, adf, lambda: np.arange(5.0)).side.tolist() == [-1, 1, -1, 1, 0]
    assert limbs_of(distances, weak, adf, lambda: np.arange(5.0), joined=True).side.tolist() == [1, -1, 1, -1, 0]


def test_three_limbs_need_more_to_tell_left_from_right():
    arms = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0]])
    distances, adf = cdist(arms, arms), np.array([2.0, 2, 1])
    for strength, left in ((0.01, 0), (0.03, 1)):  # a trunk with arms alone: poses change it by .01
        volumes = np.zeros((3, 3, 3))
        for turn in range(3):
            i, j, k = np.roll((0, 2, 1), turn)
            volumes[i, j, k], volumes[i, k, j] = strength, -strength
        side = limbs_of(distances, volumes, adf, lambda: np.arange(3.0)).side
        assert side[2] == 0
        assert np.argmax(side) == left


def test_a_swap_of_all_pairs_is_preferred_to_that_of_one():
    body = np.array([[1.0, 2, 0], [-1.1, 2, 0.1], [1.1, -2, 0.1], [-1.2, -2.1, 0], [0, 4, 0]]) / 3
    crossed = cdist(body, body)
    crossed[4, 2] = crossed[2, 4] = crossed[4, 2] * 0.95  # a pose draws one leg up
    limbs = limbs_of(crossed, np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    assert limbs.partner.tolist() == [1, 0, 3, 2, 4]


def test_the_margin_of_a_swap_over_the_next_tells_how_sure_the_sides_are():
    ends = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0]]) / 3
    square = np.array([[1.0, 1, 0], [-1, 1, 0], [1, -1, 0], [-1, -1, 0], [0, 0, 1.5]]) / 2  # a swap as good as the next
    lead = [
        limbs_of(cdist(each, each), np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0)).margin
        for each in (ends, square)
    ]
    assert lead[0] > 0.05
    assert lead[1] == pytest.approx(0, abs=1e-12)
    alone = limbs_of(np.array([[0.0, 1], [1, 0]]), np.zeros((2, 2, 2)), np.array([1.0, 9]), lambda: np.arange(2.0))
    assert (alone.partner.tolist(), alone.margin) == ([0, 1], 0)
