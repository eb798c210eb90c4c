"""The mannequin's skeleton found again in the mannequin, posed: joints, sides, toes, limits, and the stance."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import mannequin
from addon.core.mesh.geometry import vertex_areas, vertex_normals
from addon.core.rigging.articulated_fit import explained, turned_round
from addon.core.rigging.bone_fit import fitted_bones
from addon.core.rigging.evidence import beyond_limits, skin_alike, strayed, toes_forward, trunk_axes, unlike_sides
from addon.core.rigging.fitted_stance import fitted_stance, goal_turns
from addon.core.rigging.reference_rig import mannequin_rig
from addon.core.rigging.skeleton import skinned
from addon.core.run.monitor import Monitor
from addon.core.surface.working_surface import working_surface
from tests.meshes.bent_rigs import posed


@pytest.fixture(scope="module")
def rig():
    vertices, faces = mannequin()
    coarse = working_surface(vertices, faces, 2500)
    return mannequin_rig(vertices, faces).at(coarse.kept, coarse.faces)


BENDS = {
    "spine": (0, 0, 30),
    "upper_arm.L": (0, 50, 0),
    "forearm.L": (0, 0, -70),
    "upper_arm.R": (0, 20, 40),
    "thigh.L": (-50, 0, 0),
    "shin.L": (60, 0, 0),
    "thigh.R": (15, 10, 0),
}


@pytest.fixture(scope="module")
def walker(rig):
    """The mannequin in stride, with its true motions."""
    motions = posed(rig, BENDS)
    return skinned(rig.vertices, rig.weights, motions), motions


def fit_of(rig, points):
    areas = vertex_areas(points, rig.faces)
    return fitted_bones(rig, points, areas, rig.vertices, rig.weights, np.ones(len(points)))


def test_weights_are_shares_and_alike_left_and_right(rig):
    assert np.allclose(rig.weights.sum(axis=1), 1)
    skin = rig.weights.sum(axis=0)
    assert np.allclose(skin, skin[rig.mates], rtol=0.1)
    assert (skin > 0).all()


def test_at_rest_the_joints_are_where_they_are(rig):
    fit = fit_of(rig, rig.vertices)
    assert np.allclose(fit.heads, rig.skeleton.heads, atol=1e-9)
    assert np.allclose(fit.turns, np.eye(3), atol=1e-7)
    assert np.allclose(fit.scales, 1)


@pytest.mark.parametrize("size", [1.0, 0.02])
def test_joints_of_a_pose_are_found_in_any_unit(rig, walker, size):
    points, motions = walker
    fit = fit_of(rig, size * points)
    off = np.linalg.norm(fit.heads - size * motions.heads, axis=1) / (1.75 * size)
    assert off.mean() < 0.006
    assert off.max() < 0.03


def test_a_match_that_errs_in_places_hardly_moves_them(rig, walker):
    points, motions = walker
    at, weights = rig.vertices.copy(), rig.weights.copy()
    wrong = np.random.default_rng(0).choice(len(at), len(at) // 12, replace=False)
    at[wrong], weights[wrong] = at[np.roll(wrong, 7)], weights[np.roll(wrong, 7)]
    areas = vertex_areas(points, rig.faces)
    fit = fitted_bones(rig, points, areas, at, weights, np.ones(len(points)))
    assert np.linalg.norm(fit.heads - motions.heads, axis=1).mean() / 1.75 < 0.03


def test_closest_points_find_the_skeleton_from_a_match_that_slid(rig, walker):
    points, motions = walker
    areas = vertex_areas(points, rig.faces)
    at = rig.vertices + np.array([0.0, 0.02, 0.03])
    sure = np.full(len(points), 0.8)
    before = fitted_bones(rig, points, areas, at, rig.weights, sure)
    after = explained(rig, points, vertex_normals(points, rig.faces), areas, at, rig.weights, sure, Monitor())
    error = [np.linalg.norm(each.heads - motions.heads, axis=1).mean() for each in (before, after.bones)]
    assert error[1] < error[0] / 2
    assert after.residual.mean() < 0.01


def test_two_half_turns_are_none(rig):
    at, weights = turned_round(rig, *turned_round(rig, rig.vertices, rig.weights))
    assert np.linalg.norm(at - rig.vertices, axis=1).mean() < 0.03
    back = weights.argmax(axis=1) == rig.weights.argmax(axis=1)
    assert back.mean() > 0.85


def test_the_mannequin_breaks_no_limit_and_a_knee_that_bends_forward_does(rig):
    assert sum(beyond_limits(rig, fit_of(rig, rig.vertices)).values()) == 0
    backward = skinned(rig.vertices, rig.weights, posed(rig, {"shin.L": (-60, 0, 0)}))
    found = beyond_limits(rig, fit_of(rig, backward))
    assert found["shin.L"] > 30
    assert found["shin.R"] == 0


def test_sides_of_other_lengths_are_told(rig):
    assert unlike_sides(rig, fit_of(rig, rig.vertices)) < 1e-6
    longer = rig.vertices.copy()
    longer[:, 0] += 0.5 * np.maximum(longer[:, 0] - 0.2, 0)  # the left arm
    assert unlike_sides(rig, fit_of(rig, longer)) > 0.1


def test_toes_tell_the_front(rig):
    fit = fit_of(rig, rig.vertices)
    assert toes_forward(rig, fit, rig.vertices) > 0.15
    back = fitted_bones(
        rig,
        rig.vertices,
        vertex_areas(rig.vertices, rig.faces),
        *turned_round(rig, rig.vertices, rig.weights),
        np.ones(len(rig.vertices)),
    )
    assert toes_forward(rig, back, rig.vertices) < -0.15
    assert np.allclose(trunk_axes(rig, fit)[0], [1, 0, 0], atol=1e-6)


def test_the_stance_of_a_pose_is_the_t_pose(rig, walker):
    points, _ = walker
    stood = skinned(
        points, rig.weights, fitted_stance(rig, fit_of(rig, points), points, rig.weights, goal_turns(rig, "T"))
    )
    stood += rig.vertices.mean(axis=0) - stood.mean(axis=0)
    assert np.linalg.norm(stood - rig.vertices, axis=1).mean() / 1.75 < 0.01


def test_arms_hang_by_the_angle_that_is_asked_for(rig):
    motions = fitted_stance(rig, fit_of(rig, rig.vertices), rig.vertices, rig.weights, goal_turns(rig, "A"))
    stood = skinned(rig.vertices, rig.weights, motions)
    hand = rig.weights[:, rig.skeleton.names.index("hand.L")] > 0.9
    arm = rig.weights[:, rig.skeleton.names.index("upper_arm.L")] > 0.9
    way = stood[hand].mean(axis=0) - stood[arm].mean(axis=0)
    assert np.degrees(np.arctan2(-way[2], way[0])) == pytest.approx(45, abs=3)


def test_a_hand_without_skin_is_told(rig):
    areas = vertex_areas(rig.vertices, rig.faces)
    assert skin_alike(rig, areas, rig.weights) > 0.9
    lost = rig.weights.copy()
    lost[:, rig.skeleton.names.index("hand.L")] *= 0.05
    assert skin_alike(rig, areas, lost) < 0.1


def test_a_limb_off_its_way_is_told(rig):
    areas = vertex_areas(rig.vertices, rig.faces)
    assert strayed(rig, rig.vertices, areas, rig.weights, 0.0) < 8
    assert strayed(rig, rig.vertices, areas, rig.weights, 45.0) > 35
    raised = skinned(rig.vertices, rig.weights, posed(rig, {"thigh.R": (-40, 0, 0)}))
    assert 30 < strayed(rig, raised, areas, rig.weights, 0.0) < 50


def test_soles_are_flat_although_the_bones_of_the_feet_are_tipped(rig):
    tipped = fit_of(rig, rig.vertices)
    turns = tipped.turns.copy()
    feet = [rig.skeleton.names.index(f"{name}.{side}") for name in ("foot", "toe") for side in "LR"]
    turns[feet] = Rotation.from_euler("x", 25, degrees=True).as_matrix()
    motions = fitted_stance(rig, tipped._replace(turns=turns), rig.vertices, rig.weights, goal_turns(rig, "T"))
    stood = skinned(rig.vertices, rig.weights, motions)
    sole = rig.vertices[:, 2] < 0.012
    assert np.ptp(stood[sole, 2]) < 0.03
