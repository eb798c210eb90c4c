"""A T-pose by bones, and by a skeleton fitted to a body without any: as asked for, or refused with a sentence."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import (
    InvalidMeshError,
    InvalidSettingsError,
    KeptStages,
    Skeleton,
    mannequin,
    stance_by_bones,
    stance_by_match,
    transferred,
)
from addon.core.modelling.mannequins import A_POSE
from addon.core.rigging.reference_rig import mannequin_rig
from tests.core.rigging.conftest import hand_drawn
from tests.meshes import shapes


@pytest.fixture(scope="module")
def standing():
    return mannequin_rig(*mannequin())


def arms(skeleton, vertices, weights):
    """Directions from upper arms to hands."""
    found = []
    for side in "LR":
        hand, arm = (weights[:, skeleton.names.index(f"{name}.{side}")] > 0.9 for name in ("hand", "upper_arm"))
        way = vertices[hand].mean(axis=0) - vertices[arm].mean(axis=0)
        found.append(way / np.linalg.norm(way))
    return found


def test_a_rig_that_rests_in_a_t_pose_stays_as_it_is(standing):
    found = stance_by_bones(standing.vertices, standing.faces, standing.skeleton, standing.weights)
    assert np.allclose(found.vertices, standing.vertices, atol=1e-9)
    assert found.bones[:3] == ["upper_arm.L", "forearm.L", "hand.L"]
    assert found.edge_distortion < 1e-9


def test_arms_are_lowered_for_an_a_pose(standing):
    found = stance_by_bones(standing.vertices, standing.faces, standing.skeleton, standing.weights, "A")
    for way, side in zip(arms(standing.skeleton, found.vertices, standing.weights), (1, -1), strict=True):
        assert way @ [side, 0, -1] / np.sqrt(2) > np.cos(np.radians(3))


def test_a_body_that_lies_stands_up(standing):
    turn = Rotation.from_euler("xz", [90, 90], degrees=True).as_matrix()
    lying = Skeleton(
        standing.skeleton.names,
        standing.skeleton.parents,
        standing.skeleton.heads @ turn.T,
        standing.skeleton.tails @ turn.T,
    )
    found = stance_by_bones(standing.vertices @ turn.T, standing.faces, lying, standing.weights)
    moved = found.vertices - found.vertices.mean(axis=0)
    assert np.allclose(moved, standing.vertices - standing.vertices.mean(axis=0), atol=1e-9)


def test_vertices_without_weights_stay_with_the_body(standing):
    weights = standing.weights.copy()
    bare = np.arange(0, len(weights), 1000)
    weights[bare] = 0
    found = stance_by_bones(standing.vertices, standing.faces, standing.skeleton, weights)
    assert np.allclose(found.vertices[bare], standing.vertices[bare], atol=1e-9)


def test_without_a_root_of_their_own_vertices_stay_with_the_body_too():
    skeleton = hand_drawn()
    order = [skeleton.names.index("hand.L"), *(b for b, name in enumerate(skeleton.names) if name != "hand.L")]
    number = {bone: index for index, bone in enumerate(order)}
    parents = np.array([number.get(int(skeleton.parents[bone]), -1) for bone in order])
    parents[0] = -1  # moved by a target
    first = Skeleton([skeleton.names[bone] for bone in order], parents, skeleton.heads[order], skeleton.tails[order])
    points = np.vstack([first.heads, [[0, -0.1, 1.8], [0, 0.1, 1.8]]])
    weights = np.vstack([np.eye(len(order)), np.zeros((2, len(order)))])
    bare = len(order)
    found = stance_by_bones(points, [[0, 3, bare], [3, bare, bare + 1]], first, weights).vertices
    chest = first.names.index("chest")
    assert np.allclose(found[bare] - found[chest], points[bare] - points[chest])


def test_what_is_no_rig_of_a_body_is_told():
    skeleton = hand_drawn()
    count = len(skeleton.names)
    with pytest.raises(InvalidMeshError, match="no faces"):
        stance_by_bones(skeleton.heads, np.empty((0, 3), dtype=int), skeleton, np.eye(count))
    with pytest.raises(InvalidMeshError, match="no area"):
        stance_by_bones(0 * skeleton.heads, [[0, 1, 2]], skeleton, np.eye(count))
    with pytest.raises(InvalidMeshError, match="one weight of each"):
        stance_by_bones(skeleton.heads, [[0, 4, 11]], skeleton, np.full((count, count), np.nan))
    with pytest.raises(InvalidMeshError, match="one weight of each"):
        stance_by_bones(skeleton.heads, [[0, 4, 11]], skeleton, np.eye(count)[:3])
    with pytest.raises(InvalidSettingsError, match="'T' or 'A'"):
        stance_by_bones(skeleton.heads, [[0, 4, 11]], skeleton, np.eye(count), "X")
    one = Skeleton(["root"], np.array([-1]), np.zeros((1, 3)), np.ones((1, 3)))
    with pytest.raises(InvalidMeshError, match="two arms and two legs"):
        stance_by_bones(skeleton.heads, [[0, 4, 11]], one, np.ones((count, 1)))


@pytest.fixture(scope="module")
def turned_a_pose():
    """The mannequin in an A-pose, seen from the side, smaller and with its vertices in another order."""
    vertices, faces = mannequin(A_POSE)
    order = np.random.default_rng(3).permutation(len(vertices))
    turn = Rotation.from_euler("z", 70, degrees=True).as_matrix()
    return 0.01 * vertices[order] @ turn.T + 3, np.argsort(order)[faces], order


@pytest.fixture(scope="module")
def stood(turned_a_pose):
    vertices, faces, _ = turned_a_pose
    return stance_by_match(vertices, faces)


def test_a_body_without_a_rig_stands_in_a_t_pose(turned_a_pose, stood, standing):
    _, _, order = turned_a_pose
    back = np.empty_like(stood.vertices)
    back[order] = stood.vertices
    off = (back - back.mean(axis=0)) / 0.01 - (standing.vertices - standing.vertices.mean(axis=0))
    assert np.linalg.norm(off, axis=1).mean() / 1.75 < 0.015
    for way, side in zip(arms(standing.skeleton, back, standing.weights), (1, -1), strict=True):
        assert way @ [side, 0, 0] > np.cos(np.radians(5))
    assert stood.edge_distortion < 0.02
    there = transferred(stood.match, standing.vertices)[np.argsort(order)]
    assert np.linalg.norm(there - standing.vertices, axis=1).mean() < 0.03
    assert stood.match.sides == sorted(stood.match.sides)


def test_what_is_asked_for_must_exist(turned_a_pose):
    vertices, faces, _ = turned_a_pose
    with pytest.raises(InvalidSettingsError, match="side"):
        stance_by_match(vertices, faces, side=-2)
    with pytest.raises(InvalidSettingsError, match="'T' or 'A'"):
        stance_by_match(vertices, faces, pose="B")


def test_what_is_no_human_is_refused_and_made_anyway_if_asked_for():
    vertices, faces = shapes.figure(13)
    keep = KeptStages()
    with pytest.raises(InvalidMeshError, match="Nothing was made"):
        stance_by_match(vertices, faces, keep=keep)
    found = stance_by_match(vertices, faces, anyway=True, keep=keep)
    assert "stance_doubtful" in [each.kind for each in found.warnings]
    assert np.isfinite(found.vertices).all()
