"""A skeleton for a body in any pose: joints, lengths, bends and weights, from the mannequin and from a rigged body."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import InvalidMeshError, InvalidSettingsError, KeptStages, Skeleton, mannequin, rig
from addon.core.rigging.bone_fit import BoneFit
from addon.core.rigging.fitted_rig import bend_axes, filled_in, with_equal_sides
from addon.core.rigging.reference_rig import ReferenceRig, mannequin_rig
from addon.core.rigging.skeleton import skinned
from addon.core.surface.laplacian import stiffness_and_mass
from addon.core.surface.triangulation import triangulated
from tests.core.rigging.test_fitted_skeletons import BENDS
from tests.meshes import shapes
from tests.meshes.bent_rigs import posed


@pytest.fixture(scope="module")
def lender():
    return mannequin_rig(*mannequin())


@pytest.fixture(scope="module")
def walker(lender):
    """The mannequin in stride, lying somewhere, in millimetres, its vertices in another order; and its true motions."""
    motions = posed(lender, BENDS)
    points = skinned(lender.vertices, lender.weights, motions)
    turn = Rotation.from_euler("z", 130, degrees=True).as_matrix()
    order = np.random.default_rng(5).permutation(len(points))
    there = lambda at: 1000 * at @ turn.T + [40.0, -70, 12]  # noqa: E731
    return there(points)[order], np.argsort(order)[lender.faces], there(motions.heads), order


@pytest.fixture(scope="module")
def keep():
    return KeptStages()


@pytest.fixture(scope="module")
def rigged(walker, keep):
    return rig(walker[0], walker[1], keep=keep)


def test_joints_are_found_in_the_unit_and_the_place_of_the_mesh(rigged, walker):
    off = np.linalg.norm(rigged.skeleton.heads - walker[2], axis=1) / 1750
    assert off.mean() < 0.01
    assert off.max() < 0.035


def test_weights_are_those_of_the_reference(rigged, walker, lender):
    assert np.allclose(rigged.weights.sum(axis=1), 1)
    off = np.abs(rigged.weights - lender.weights[walker[3]]).sum(axis=1) / 2
    assert off.mean() < 0.05
    assert rigged.confidence.shape == (len(rigged.skeleton.names),)
    assert ((rigged.confidence > 0) & (rigged.confidence <= 1)).all()
    assert rigged.confidence.mean() > 0.5


def test_left_and_right_are_equally_long_if_asked_for(rigged, walker, keep, lender):
    long = lambda found: np.linalg.norm(found.skeleton.tails - found.skeleton.heads, axis=1)  # noqa: E731
    assert np.allclose(long(rigged), long(rigged)[lender.mates])
    free = rig(walker[0], walker[1], equal=False, keep=keep)
    assert not np.allclose(long(free), long(free)[lender.mates], rtol=1e-4)
    for found in (rigged, free):
        knee = found.skeleton.names.index("shin.L")
        assert np.allclose(found.skeleton.heads[knee], found.skeleton.tails[knee - 2])  # the thigh


def test_bends_are_across_bones_and_knees_bend_in_their_plane(rigged):
    ways = rigged.skeleton.tails - rigged.skeleton.heads
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    assert np.allclose(np.linalg.norm(rigged.bends, axis=1), 1)
    assert np.abs(np.einsum("bi,bi->b", ways, rigged.bends)).max() < 1e-9
    number = rigged.skeleton.names.index
    for upper, lower in (("thigh.L", "shin.L"), ("upper_arm.L", "forearm.L")):  # bent by 60 and 70 degrees
        hinge = np.cross(ways[number(upper)], ways[number(lower)])
        hinge /= np.linalg.norm(hinge)
        assert rigged.bends[number(lower)] @ hinge > 0.99


def test_a_straight_leg_bends_about_what_its_foot_tells(lender):
    bones = lender.skeleton
    fit = BoneFit(
        bones.heads, bones.tails, np.repeat(np.eye(3)[None], len(bones.names), 0), np.ones((len(bones.names), 2))
    )
    found = bend_axes(lender, fit)
    for name in ("thigh.L", "shin.R", "spine"):
        assert found[bones.names.index(name)] @ [1, 0, 0] > 0.95
    assert np.allclose(with_equal_sides(lender, fit).tails, bones.tails)


def test_weights_flow_to_where_they_are_not_trusted(lender):
    vertices, faces = shapes.sphere(3)
    stiffness, mass = stiffness_and_mass(triangulated(vertices / np.sqrt(4 * np.pi), faces))
    right = vertices[:, 0] > 0
    weights = np.column_stack([right, ~right]).astype(float)
    wrong = vertices[:, 0] > 0.8
    weights[wrong] = [0, 1]
    found = filled_in(weights, np.where(wrong, 0.0, 1.0), stiffness, mass)
    assert np.allclose(found.sum(axis=1), 1)
    assert (found[wrong, 0] > 0.95).all()
    assert np.abs(found - weights)[(np.abs(vertices[:, 0]) > 0.3) & ~wrong].max() < 0.05


def test_any_rigged_body_lends_its_skeleton(walker, lender):
    bones = lender.skeleton
    order = np.roll(np.arange(len(bones.names)), 7)  # children before their parents
    names = [f"bone {bone}" for bone in order]
    back = np.append(np.argsort(order), -1)
    own = Skeleton(names, back[bones.parents[order]], 20 * bones.heads[order], 20 * bones.tails[order])
    weights = 2 * lender.weights[:, order]
    weights[:5] = 0  # which nothing holds
    found = rig(walker[0], walker[1], ReferenceRig(20 * lender.vertices, lender.faces, own, weights))
    at = [found.skeleton.names.index(f"bone {bone}") for bone in range(len(names))]
    off = np.linalg.norm(found.skeleton.heads[at] - walker[2], axis=1) / 1750
    assert off.mean() < 0.006
    assert off.max() < 0.025
    above = [found.skeleton.parents[each] for each in at]
    assert [found.skeleton.names[each] if each >= 0 else "" for each in above] == [
        f"bone {each}" if each >= 0 else "" for each in bones.parents
    ]
    assert np.allclose(found.weights.sum(axis=1), 1)


def test_another_skeleton_of_the_same_skin_is_another_rig(walker, lender, keep):
    found = rig(walker[0], walker[1], lender, keep=keep)
    bones = lender.skeleton
    names = [f"bone {name}" for name in bones.names]
    aside = np.array([0.02, 0, 0])
    moved = Skeleton(names, bones.parents, bones.heads + aside, bones.tails + aside)
    other = rig(walker[0], walker[1], lender._replace(skeleton=moved), keep=keep)
    assert other.skeleton.names[0].startswith("bone")
    assert np.abs(other.skeleton.heads[0] - found.skeleton.heads[0]).max() > 5


def test_a_joint_may_lie_on_the_skin(walker, lender):
    bones = lender.skeleton
    heads = bones.heads.copy()
    heads[5] = lender.vertices[1000]
    found = rig(walker[0], walker[1], lender._replace(skeleton=bones._replace(heads=heads)), anyway=True)
    assert np.isfinite(found.skeleton.heads).all()
    assert np.isfinite(found.weights).all()


@pytest.mark.parametrize(
    "wrong",
    [
        {"parents": np.array([-1, 5])},
        {"parents": np.array([1, 0])},
        {"parents": np.array([-1.0, 0.0])},
        {"heads": np.full((2, 3), np.nan)},
        {"names": ["one"]},
    ],
)
def test_what_is_no_skeleton_is_told(lender, wrong):
    heads, tails = np.array([[0.0, 0, 0], [0, 0, 1]]), np.array([[0.0, 0, 1], [0, 0, 2]])
    bones = Skeleton(["one", "two"], np.array([-1, 0]), heads, tails)._replace(**wrong)
    given = ReferenceRig(lender.vertices, lender.faces, bones, np.ones((len(lender.vertices), 2)))
    with pytest.raises(InvalidMeshError, match="one weight of each"):
        rig(lender.vertices, lender.faces, given)


def test_what_is_no_human_is_refused(lender):
    vertices, faces = shapes.figure(13)
    with pytest.raises(InvalidMeshError, match="Nothing was made"):
        rig(vertices, faces)
    with pytest.raises(InvalidMeshError, match="one weight of each"):
        rig(vertices, faces, lender._replace(weights=lender.weights[:, :3]))
    with pytest.raises(InvalidSettingsError, match="side"):
        rig(vertices, faces, side=-2)
