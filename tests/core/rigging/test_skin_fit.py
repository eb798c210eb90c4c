"""Bones laid by the skin that they carry together: a posed body is met, skin slides, bones without skin go along."""

import numpy as np
import pytest

from addon.core import Skeleton
from addon.core.mesh.geometry import vertex_areas, vertex_normals
from addon.core.rigging import skin_fit
from addon.core.rigging.bone_fit import BoneFit, connected, fitted_bones, stretches
from addon.core.rigging.reference_rig import ReferenceRig
from addon.core.rigging.skin_fit import laid_bones
from tests.core.rigging.test_fitted_skeletons import rig, walker  # noqa: F401

STEPS = 8


def laid(rig, bones, points, at, weights, steps=1):  # noqa: F811
    areas, normals = vertex_areas(points, rig.faces), vertex_normals(points, rig.faces)
    for _ in range(steps):
        bones = laid_bones(rig, bones, points, normals, at, weights, areas)
    return bones


def at_rest(rig):  # noqa: F811
    count = len(rig.skeleton.names)
    return BoneFit(
        rig.skeleton.heads, rig.skeleton.tails, np.broadcast_to(np.eye(3), (count, 3, 3)), np.ones((count, 2))
    )


def off(bones, motions):
    return np.linalg.norm(bones.heads - motions.heads, axis=1) / 1.75


def test_a_body_at_rest_stays(rig):  # noqa: F811
    bones = laid(rig, at_rest(rig), rig.vertices, rig.vertices, rig.weights)
    assert np.allclose(bones.heads, rig.skeleton.heads, atol=1e-7)
    assert np.allclose(bones.turns, np.eye(3), atol=1e-6)
    assert np.allclose(bones.scales, 1, atol=1e-6)


def test_a_posed_body_is_met_where_bones_fitted_one_by_one_err(rig, walker):  # noqa: F811
    points, motions = walker
    alone = fitted_bones(rig, points, vertex_areas(points, rig.faces), rig.vertices, rig.weights, np.ones(len(points)))
    together = laid(rig, alone, points, rig.vertices, rig.weights, STEPS)
    assert off(together, motions).max() < 0.1 * off(alone, motions).max()
    there = together.posed(rig, rig.vertices, rig.weights)
    assert np.linalg.norm(there - points, axis=1).max() / 1.75 < 1e-3


def test_skin_may_slide_over_a_body_and_draws_bones_along_less(rig, monkeypatch):  # noqa: F811
    forearm = rig.skeleton.names.index("forearm.L")
    at = rig.vertices - 0.03 * rig.weights[:, [forearm]] * [1.0, 0, 0]  # closest points that slid along the arm
    away = []
    for sliding in (skin_fit._SLIDING, 1.0):
        monkeypatch.setattr(skin_fit, "_SLIDING", sliding)
        found = laid(rig, at_rest(rig), rig.vertices, at, rig.weights)
        away.append(np.linalg.norm(found.heads - rig.skeleton.heads, axis=1)[forearm])
    assert away[0] < 0.8 * away[1]


def test_both_sides_keep_alike_where_the_skin_does_not_tell(rig):  # noqa: F811
    left = [rig.skeleton.names.index(f"{name}.L") for name in ("upper_arm", "forearm", "hand")]
    scales = np.ones((len(rig.skeleton.names), 2))
    scales[left] = 1.2
    unseen = np.where(rig.weights[:, left].sum(axis=1) > 0.05, 1e-6, 1.0)
    areas, normals = vertex_areas(rig.vertices, rig.faces), vertex_normals(rig.vertices, rig.faces)
    longer = at_rest(rig)._replace(scales=scales)
    found = laid_bones(rig, longer, rig.vertices, normals, rig.vertices, rig.weights, areas * unseen)
    assert (found.scales[left, 1] < 1.08).all()  # 1.1 where each keeps its own


@pytest.mark.parametrize("place", ["tip", "root"])
def test_bones_without_skin_go_along(rig, walker, place):  # noqa: F811
    points, _ = walker
    names, parents, heads, tails = rig.skeleton
    hand = names.index("hand.L")
    if place == "tip":
        skeleton = Skeleton(
            [*names, "prop"],
            np.append(parents, hand),
            np.vstack([heads, tails[hand]]),
            np.vstack([tails, tails[hand] + [0.1, 0, 0]]),
        )
        weights = np.column_stack([rig.weights, np.zeros(len(points))])
    else:
        skeleton = Skeleton(
            ["origin", *names],
            np.concatenate([[-1], parents + 1]),
            np.vstack([[0.0, 0, 0], heads]),
            np.vstack([[0.0, 0, 0.1], tails]),
        )
        weights = np.column_stack([np.zeros(len(points)), rig.weights])
    larger = ReferenceRig(rig.vertices, rig.faces, skeleton, weights)
    bones = laid(larger, at_rest(larger), points, larger.vertices, larger.weights, STEPS)
    source, own = (hand, -1) if place == "tip" else (1, 0)
    grown = stretches(larger.axes, bones.scales)[source] @ (skeleton.heads[own] - skeleton.heads[source])
    assert np.allclose(bones.turns[own], bones.turns[source])
    assert np.allclose(bones.heads[own], bones.heads[source] + bones.turns[source] @ grown)


@pytest.mark.parametrize("names", ["{}_{}", "{1} {0}"])
def test_partners_are_known_by_place_where_names_do_not_tell(drawn_rig, names):
    def mates(spelling, aside=0.0):
        skeleton = drawn_rig(names=spelling)
        way = np.array([aside, 0, 0])
        skeleton = skeleton._replace(heads=skeleton.heads + way, tails=skeleton.tails + way)
        return ReferenceRig(skeleton.heads, np.zeros((0, 3), int), skeleton, np.eye(len(skeleton.names))).mates

    named = mates("{}.{}")
    assert (named != np.arange(len(named))).sum() == 14
    placed = mates(names, aside=3.0)
    sure = [each for each in range(len(named)) if each not in (3, 10)]  # collarbones begin in the middle
    assert (placed[sure] == named[sure]).all()


def test_props_on_one_side_and_twists_do_not_mix_partners(drawn_rig):
    skeleton = drawn_rig(names="{}_{}")
    names, count = skeleton.names, len(skeleton.names)
    arm = [names.index(f"upper_arm_{side}") for side in "LR"]
    hand = names.index("hand_R")
    heads = np.vstack([skeleton.heads, skeleton.heads[arm[::-1]], skeleton.tails[[hand, hand]]])
    tails = np.vstack([skeleton.tails, (skeleton.heads + skeleton.tails)[arm[::-1]] / 2, heads[-2:] - [0.4, 0, 0]])
    whole = Skeleton(
        [*names, "twist_R", "twist_L", "sword", "blade"],
        np.concatenate([skeleton.parents, arm[::-1], [hand, hand]]),
        heads,
        tails,
    )
    weights = np.eye(count + 4)
    weights[:, -2:] = 0
    mates = ReferenceRig(heads, np.zeros((0, 3), int), whole, weights).mates
    assert mates[arm[0]] == arm[1]
    assert mates[count] == count + 1
    assert (mates[-2:] == [count + 2, count + 3]).all()


def test_a_bone_that_is_a_point_turns_nowhere(rig, walker):  # noqa: F811
    points, _ = walker
    thigh = rig.skeleton.names.index("thigh.L")
    names, parents, heads, tails = rig.skeleton
    skeleton = Skeleton(
        [*names, "socket"],
        np.append(np.where(np.arange(len(names)) == thigh, len(names), parents), parents[thigh]),
        np.vstack([heads, heads[thigh]]),
        np.vstack([tails, heads[thigh]]),
    )
    weights = np.column_stack([rig.weights, np.zeros(len(points))])
    weights[:, -1] = weights[:, thigh] / 2
    weights[:, thigh] /= 2
    larger = ReferenceRig(rig.vertices, rig.faces, skeleton, weights)
    bones = connected(larger, laid(larger, at_rest(larger), points, larger.vertices, larger.weights, STEPS))
    there = bones.posed(larger, larger.vertices, larger.weights)
    assert np.linalg.norm(there - points, axis=1).max() / 1.75 < 0.03  # .08 if it does
