"""Bones laid by the skin that they carry together: a posed body is met, skin slides, bones without skin go along."""

import numpy as np
import pytest

from addon.core import Skeleton
from addon.core.mesh.geometry import vertex_areas, vertex_normals
from addon.core.rigging.bone_fit import BoneFit, fitted_bones, stretches
from addon.core.rigging.reference_rig import ReferenceRig
from addon.core.rigging.skin_fit import laid_bones
from tests.core.rigging.test_fitted_skeletons import rig, walker  # noqa: F401

STEPS = 8


def laid(rig, bones, points, at, weights, steps=1):  # noqa: F811
    areas, normals = vertex_areas(points, rig.faces), vertex_normals(points, rig.faces)
    for _ in range(steps):
        bones = laid_bones(rig, bones, points, normals, areas, at, weights, np.ones(len(points)))
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


def test_skin_may_slide_over_a_body_without_drawing_bones_along(rig, walker):  # noqa: F811
    points, _ = walker
    normals = vertex_normals(points, rig.faces)
    slid = np.cross(normals, np.random.default_rng(1).normal(size=points.shape))
    slid *= 0.01 / np.linalg.norm(slid, axis=1, keepdims=True)
    alone = fitted_bones(rig, points, vertex_areas(points, rig.faces), rig.vertices, rig.weights, np.ones(len(points)))
    still, moved = (laid(rig, alone, each, rig.vertices, rig.weights, STEPS) for each in (points, points + slid))
    assert np.linalg.norm(still.heads - moved.heads, axis=1).mean() < 0.002


def test_both_sides_keep_alike_where_the_skin_does_not_tell(rig):  # noqa: F811
    bones = at_rest(rig)
    left = rig.skeleton.names.index("upper_arm.L")
    scales = bones.scales.copy()
    scales[left] = 1.1
    longer = bones._replace(scales=scales)
    flat = np.tile([0.0, 0, 1], (len(rig.vertices), 1))  # normals along which nothing tells lengths of arms
    areas = vertex_areas(rig.vertices, rig.faces)
    found = laid_bones(
        rig, longer, rig.vertices, flat, areas, rig.vertices, rig.weights, np.full(len(rig.vertices), 1.0)
    )
    assert abs(found.scales[left, 0] - found.scales[rig.mates[left], 0]) < 0.02


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
