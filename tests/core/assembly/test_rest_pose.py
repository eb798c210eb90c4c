"""The rest pose of a rig tells what belongs together, the pose what is unfolded."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import InvalidMeshError, Settings, canonical_form, feature_patches, match, pose_like
from addon.core.assembly.bodies import bodies_of
from addon.core.assembly.rest_pose import bodies_at_rest
from addon.core.limbs import limb_shapes
from addon.core.mesh.geometry import surface_area
from addon.core.run.monitor import Monitor
from tests.core.assembly.test_dolls import capsule
from tests.meshes import pieced, shapes

QUICK = Settings(quality="draft")


def together(*pieces):
    """Pieces as one mesh."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    faces = [each + start for (_, each), start in zip(pieces, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in pieces]), np.concatenate(faces)


def arm(at, to):
    return capsule(0.1, at, to)


@pytest.fixture(scope="module")
def trunk():
    return capsule(0.3, [0, 0, 0], [0, 0, 1.5])


def test_what_only_touches_in_the_pose_does_not_belong_together(trunk):
    posed, faces = together(trunk, arm([0.35, 0, 0.5], [1.5, 0, 0.5]))
    rest, _ = together(trunk, arm([3.35, 0, 0.5], [4.5, 0, 0.5]))
    assert len(bodies_of(posed, faces).bodies) == 1
    assert len(bodies_at_rest(posed, faces, rest, Monitor()).bodies) == 2


def test_what_touches_at_rest_belongs_together_though_the_pose_opens_it(trunk):
    posed, faces = together(trunk, arm([0.62, 0, 0.5], [1.8, 0, 0.5]))
    rest, _ = together(trunk, arm([0.35, 0, 0.5], [1.5, 0, 0.5]))
    assert len(bodies_of(posed, faces).bodies) == 2
    (body,) = bodies_at_rest(posed, faces, rest, Monitor()).bodies
    np.testing.assert_array_equal(body.points, posed[body.vertices])


def test_what_one_rig_moves_is_one_body_though_nothing_holds_it(trunk):
    """Two balls that only touch, as chest and belly of a doll do, and a head that floats."""
    ball, faces = shapes.sphere(3)
    places = ball, ball + np.array([0, 0, 2.01]), 0.5 * ball + np.array([0, 0, 3.6])
    vertices, faces = together(*((each, faces) for each in places))
    assert len(bodies_of(vertices, faces).bodies) > 1
    assert len(bodies_at_rest(vertices, faces, vertices, Monitor()).bodies) == 1


def test_points_and_their_numbers_are_those_of_the_rest():
    rest, faces = shapes.figure()
    posed = rest + np.array([0.3, 0, 0]) * np.sin(rest[:, 2:])
    resting, alone = canonical_form(rest, faces, QUICK), canonical_form(posed, faces, QUICK)
    given = canonical_form(posed, faces, QUICK, rest=rest)
    np.testing.assert_array_equal(given.feature_points, resting.feature_points)
    assert (alone.feature_points != resting.feature_points).any()
    (one,), (other,) = given.bodies, resting.bodies
    np.testing.assert_array_equal(one.limbs.side, other.limbs.side)
    np.testing.assert_array_equal(one.limbs.partner, other.limbs.partner)
    assert np.abs(one.limbs.distances - other.limbs.distances).max() > 0.005  # those of the pose


def test_a_hand_on_a_hip_is_not_bridged_there(trunk):
    """Both ends of the arm touch the trunk in the pose; at rest, only its shoulder does."""
    rest, faces = together(trunk, arm([0.35, 0, 1.4], [1.7, 0, 1.4]))
    own = rest[len(trunk[0]) :]
    along = np.clip((own[:, 0] - 0.35) / 1.35, 0, 1)
    way = np.array([[0.3, 0, 1.4], [0.9, 0, 0.9], [0.3, 0, 0.25]])  # shoulder, elbow, hand
    middle = np.column_stack([np.interp(along, [0, 0.5, 1], axis) for axis in way.T])
    posed = np.concatenate(
        [trunk[0], own + middle - np.column_stack([0.35 + 1.35 * along, 0 * along, 0 * along + 1.4])]
    )
    hand = len(trunk[0]) + int(np.argmax(rest[len(trunk[0]) :, 0]))
    forms = [canonical_form(posed, faces, QUICK, rest=each).vertices for each in (None, rest)]
    hip = np.linalg.norm(trunk[0] - [0.3, 0, 0.25], axis=1).argmin()
    without, given = (np.linalg.norm(form[hand] - form[hip]) for form in forms)
    assert given > 1.2 > without


def test_seams_that_the_pose_opens_are_closed_as_at_rest():
    vertices, faces = shapes.cylinder(24, 40)
    rest, cut = shapes.cut_along_seams(vertices, faces)
    opened = rest + 0.002 * np.random.default_rng(0).standard_normal(rest.shape)
    assert (
        len(bodies_at_rest(opened, cut, rest, Monitor()).pieces.pieces) == len(bodies_of(rest, cut).pieces.pieces) == 1
    )
    form = canonical_form(opened, cut, QUICK, rest=rest)
    copies = [np.ptp(form.vertices[(rest == place).all(axis=1)], axis=0).max() for place in np.unique(rest, axis=0)]
    assert max(copies) == 0


def test_the_pose_as_its_own_rest_changes_nothing():
    made = pieced.character()[2]
    one = canonical_form(made.vertices, made.faces, QUICK)
    two = canonical_form(made.vertices, made.faces, QUICK, rest=made.vertices)
    np.testing.assert_allclose(one.vertices, two.vertices, atol=1e-9)
    np.testing.assert_array_equal(one.feature_points, two.feature_points)


def test_size_and_place_of_the_rest_do_not_matter():
    made = pieced.character()[2]
    turn = Rotation.from_euler("xyz", [20, 130, 50], degrees=True)
    elsewhere = 40.0 * turn.apply(made.vertices) + 100.0
    one, two = (canonical_form(made.vertices, made.faces, QUICK, rest=rest) for rest in (made.vertices, elsewhere))
    np.testing.assert_array_equal(one.feature_points, two.feature_points)
    assert np.abs(one.vertices - two.vertices).max() < 1e-3 * np.sqrt(surface_area(made.vertices, made.faces))


def test_riders_follow_the_pose_not_the_rest():
    made = pieced.character()[2]
    rest = made.vertices @ np.diag([1.0, 1.0, 1.1])
    form = canonical_form(made.vertices, made.faces, QUICK, rest=rest)
    alone = canonical_form(made.vertices, made.faces, QUICK)
    size = np.sqrt(surface_area(made.vertices, made.faces))
    for name in ("shirt", "eye"):
        own = made.pieces[name]
        assert np.linalg.norm(form.vertices[own] - alone.vertices[own], axis=1).mean() < 0.05 * size


@pytest.mark.parametrize(("at_rest", "in_pose"), [(30.0, 20.0), (30.0, 0.0), (0.0, 20.0)])
def test_strays_stay_with_their_neighbours(at_rest, in_pose):
    vertices, faces = shapes.figure()
    rest = vertices.copy()
    rest[7] += at_rest
    posed = vertices + np.array([5.0, 0, 0])
    posed[7] += in_pose
    form = canonical_form(posed, faces, QUICK, rest=rest)
    assert "stray_vertices" in [told.kind for told in form.warnings]
    clean = canonical_form(vertices + np.array([5.0, 0, 0]), faces, QUICK)
    others = np.arange(len(vertices)) != 7
    assert np.abs(form.vertices - clean.vertices)[others].max() < 0.1


@pytest.mark.parametrize("pieces", ["together", "apart"])
@pytest.mark.parametrize("hidden", ["in the pose", "at rest"])
def test_a_piece_that_is_shrunk_to_a_point_is_left_out_only_where_it_is(pieces, hidden, trunk):
    """As games hide what a character does not wear: by a bone of scale 0."""
    shown, faces = together(trunk, arm([0.35, 0, 0.5], [1.5, 0, 0.5]))
    shrunk = shown.copy()
    shrunk[len(trunk[0]) :] = [0.3, 0, 0.5]
    posed, rest = (shrunk, shown) if hidden == "in the pose" else (shown, shrunk)
    form = canonical_form(posed, faces, Settings(quality="draft", pieces=pieces), rest=rest)
    told = [each.kind for each in form.warnings]
    assert ("pieces_without_area" in told) == (hidden == "in the pose")
    assert "loose_vertices" not in told
    own = slice(len(trunk[0]), None)
    assert np.array_equal(form.vertices[own], posed[own]) == (hidden == "in the pose")


def test_successive_runs_keep_as_much_as_without_a_rest(monkeypatch):
    from addon.core import KeptStages
    from addon.core.method_api import surface_features

    rest, faces = shapes.figure(16)
    posed = rest + np.array([0.3, 0, 0]) * np.sin(rest[:, 2:])
    counted, keep = [], KeptStages()
    spectrum = surface_features.compute_spectrum

    def counting(*some):
        counted.append(1)
        return spectrum(*some)

    monkeypatch.setattr(surface_features, "compute_spectrum", counting)
    for pairs in (60, 70, 80):
        canonical_form(posed, faces, Settings(quality="draft", eigenpairs=pairs), rest=rest, keep=keep)
    assert len(counted) == 6
    known = canonical_form(posed, faces, Settings(quality="draft", eigenpairs=60), rest=rest, keep=keep)
    assert len(counted) == 6
    rest[:] = rest @ np.diag([1, 1, 0.2])  # in place, as a caller may reuse an array
    again = canonical_form(posed, faces, Settings(quality="draft", eigenpairs=60), rest=rest, keep=keep)
    assert (known.feature_points != again.feature_points).any()


def test_every_door_takes_it(trunk):
    posed, faces = together(trunk, arm([0.35, 0, 0.5], [1.5, 0, 0.5]))
    rest, _ = together(trunk, arm([3.35, 0, 0.5], [4.5, 0, 0.5]))
    assert len(feature_patches(posed, faces, QUICK, rest=rest).bodies) == 2
    form = canonical_form(posed, faces, QUICK, rest=rest)
    assert len(form.bodies) == 2
    chosen = form.patches == form.patches[0]
    (shape,) = limb_shapes(posed, faces, form.vertices, chosen, rest=rest)
    np.testing.assert_allclose(shape[len(trunk[0]) :], posed[len(trunk[0]) :])  # the arm is another body
    vertices, corners = trunk
    matched = match(posed, faces, vertices, corners, QUICK, rest=rest)
    like = pose_like(posed, faces, vertices, corners, QUICK, rest=rest)
    assert all("match_bodies" in [told.kind for told in each.warnings] for each in (matched, like))


def test_a_rest_of_another_mesh_is_refused(trunk):
    vertices, faces = trunk
    with pytest.raises(InvalidMeshError, match=f"each of the {len(vertices) + 1} vertices"):
        canonical_form(np.vstack([vertices, [0, 0, 0]]), faces, rest=vertices)
    with pytest.raises(InvalidMeshError, match="no area"):
        canonical_form(0 * vertices, faces, rest=vertices)
    with pytest.raises(InvalidMeshError, match="not numbers"):
        canonical_form(vertices + np.nan, faces, rest=vertices)
