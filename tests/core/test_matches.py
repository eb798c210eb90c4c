"""Two meshes matched, and posed like each other."""

from dataclasses import replace

import numpy as np
import pytest

from addon.core import (
    CancelledError,
    InvalidMeshError,
    InvalidSettingsError,
    Settings,
    canonical_form,
    feature_patches,
    match,
    pose_like,
    transferred,
)
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.coarsening import coarsened
from addon.core.mesh.geometry import surface_area
from tests.meshes import shapes

DRAFT = Settings(quality="draft")


@pytest.fixture(scope="module")
def poses():
    """The figure, straight and under other numbers in its bent pose; also the old number of every new vertex."""
    vertices, faces = shapes.figure(15)
    straight = canonical_form(vertices, faces, DRAFT).vertices
    return (straight, faces), shapes.permuted(vertices, faces)


@pytest.fixture(scope="module")
def matched(poses):
    (straight, faces), (bent, bent_faces, _) = poses
    return match(straight, faces, bent, bent_faces, DRAFT)


def places(found, vertices):
    return np.einsum("ij,ijk->ik", found.weights, vertices[found.other_faces[found.faces]])


def distance(one, two):
    rotation, shift = rigid_fit(one, two)
    return float(np.sqrt(((one @ rotation + shift - two) ** 2).sum(axis=1).mean()))


def test_every_vertex_finds_its_like_in_another_pose(poses, matched):
    bent, bent_faces, old = poses[1]
    truth = bent[np.argsort(old)]
    off = np.linalg.norm(places(matched, bent) - truth, axis=1) / np.sqrt(surface_area(bent, bent_faces))
    assert off.mean() < 0.02
    assert np.mean(off < 0.1) > 0.99
    assert matched.sides == sorted(matched.sides)
    assert [told.kind for told in matched.warnings] == ["one_pair"]  # among the five limbs of the figure


def test_vertices_faces_and_weights_tell_the_same(matched):
    corners = matched.other_faces[matched.faces]
    assert (
        np.take_along_axis(corners, np.argmax(matched.weights, axis=1)[:, None], axis=1)[:, 0] == matched.vertices
    ).all()
    np.testing.assert_allclose(matched.weights.sum(axis=1), 1)
    assert matched.confidence.min() >= 0
    assert matched.confidence.max() <= 1


def test_a_mesh_onto_itself_is_the_same_everywhere():
    vertices, faces = shapes.figure(15)
    found = match(vertices, faces, vertices, faces, DRAFT)
    np.testing.assert_allclose(places(found, vertices), vertices, atol=1e-6)
    assert found.confidence.mean() > 0.9


def test_motion_and_size_of_either_change_nothing(poses, matched, rotation):
    (straight, faces), (bent, bent_faces, _) = poses
    other = match(100 * straight @ rotation + 7, faces, bent @ rotation.T - 3, bent_faces, DRAFT)
    apart = np.linalg.norm(places(other, bent) - places(matched, bent), axis=1)
    assert np.quantile(apart, 0.9) < 1e-3 * np.sqrt(surface_area(bent, bent_faces))
    np.testing.assert_allclose(other.sides[0], matched.sides[0], atol=1e-3)


def test_the_same_meshes_have_the_same_match(poses, matched):
    (straight, faces), (bent, bent_faces, _) = poses
    again = match(straight, faces, bent, bent_faces, DRAFT)
    assert (again.faces == matched.faces).all()
    assert (again.weights == matched.weights).all()


def test_weights_of_bones_stay_weights(poses, matched):
    bent = poses[1][0]
    bones = np.random.default_rng(0).dirichlet(np.ones(4), len(bent))
    carried = transferred(matched, bones)
    assert carried.shape == (len(matched.vertices), 4)
    np.testing.assert_allclose(carried.sum(axis=1), 1)
    assert transferred(matched, bones[:, 0]).shape == (len(matched.vertices),)
    with pytest.raises(InvalidMeshError, match="one item per vertex of the other mesh"):
        transferred(matched, bones[:-1])


def test_another_side_is_another_match(poses, matched):
    (straight, faces), (bent, bent_faces, _) = poses
    assert len(matched.sides) > 1
    other = match(straight, faces, bent, bent_faces, DRAFT, side=1)
    doubts = ["match_sides" in [each.kind for each in found.warnings] for found in (matched, other)]
    assert doubts[0] == doubts[1]  # which side was asked for settles no doubt
    apart = np.linalg.norm(places(other, bent) - places(matched, bent), axis=1)
    assert apart.mean() > 0.1 * np.sqrt(surface_area(bent, bent_faces))
    with pytest.raises(InvalidSettingsError, match="ways to match"):
        match(straight, faces, bent, bent_faces, DRAFT, side=99)


@pytest.mark.parametrize("side", ["left", -1, 1.5, True, None])
def test_what_is_no_side_is_refused_at_once(side):
    with pytest.raises(InvalidSettingsError, match="side must be"):
        match([], [], [], [], DRAFT, side=side)


def test_unlike_bodies_are_told():
    found = match(*shapes.figure(15), *shapes.joint(40), DRAFT)
    assert "match_unlike" in [each.kind for each in found.warnings]


def test_posed_like_the_bent_one_it_is_the_bent_one(poses):
    (straight, faces), (bent, bent_faces, old) = poses
    posed = pose_like(straight, faces, bent, bent_faces, DRAFT)
    truth = bent[np.argsort(old)]
    assert distance(posed.vertices, truth) < 0.12 * distance(straight, truth)
    assert posed.edge_distortion < 0.05
    apart = posed.vertices - truth
    standing = np.sqrt(((apart - apart.mean(axis=0)) ** 2).sum(axis=1).mean())
    assert standing < 0.15 * distance(straight, truth)  # it stands as the other does, without a turn
    np.testing.assert_allclose(surface_area(posed.vertices, faces), surface_area(straight, faces), rtol=0.05)


@pytest.mark.parametrize(("stretch", "share"), [(1.2, 0.54), (1.4, 0.45), (1.5, 0.42)])
def test_a_body_keeps_its_shape_in_the_pose_of_another(poses, stretch, share):
    (straight, faces), (bent, bent_faces, old) = poses
    longer = straight * [1.0, 1.0, stretch]
    posed = pose_like(longer, faces, bent, bent_faces, DRAFT)
    length = lambda points: np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1)  # noqa: E731
    kept = np.abs(np.log(length(posed.vertices) / length(longer)))
    copied = np.abs(np.log(length(bent[np.argsort(old)]) / length(longer)))
    assert np.median(kept) < share * np.median(copied)


def test_several_bodies_are_matched_by_size(poses):
    (straight, faces), (bent, bent_faces, _) = poses
    ball, ball_faces = shapes.sphere(2)
    two = np.concatenate([0.2 * ball + 20, straight]), np.concatenate([ball_faces, faces + len(ball)])
    posed = pose_like(*two, bent, bent_faces, DRAFT)
    found = posed.match
    assert "match_bodies" in [each.kind for each in found.warnings]
    assert (found.vertices[: len(ball)] == -1).all()
    assert (found.vertices[len(ball) :] >= 0).all()
    assert (transferred(found, np.ones(len(bent)))[: len(ball)] == 0).all()
    np.testing.assert_array_equal(posed.vertices[: len(ball)], two[0][: len(ball)])


def test_progress_rises_to_its_end(poses):
    (straight, faces), (bent, bent_faces, _) = poses
    done: list[float] = []
    pose_like(straight, faces, bent, bent_faces, DRAFT, progress=lambda part, _: done.append(part))
    assert done == sorted(done)
    assert done[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("at", [0.3, 0.85])
def test_it_stops_when_asked(at, poses):
    (straight, faces), (bent, bent_faces, _) = poses
    seen = [0.0]
    with pytest.raises(CancelledError):
        pose_like(
            straight, faces, bent, bent_faces, DRAFT,
            progress=lambda part, _: seen.append(part), cancelled=lambda: seen[-1] > at,
        )  # fmt: skip


def test_an_error_says_which_mesh_is_meant(poses):
    (straight, faces), (bent, bent_faces, _) = poses
    with pytest.raises(InvalidMeshError, match=r"^The other mesh: Faces refer to vertices outside") as raised:
        match(straight, faces, bent, bent_faces + 1, DRAFT)
    assert raised.value.kind == "face_range"
    with pytest.raises(InvalidMeshError, match=r"^Faces refer"):
        match(straight, faces + 1, bent, bent_faces, DRAFT)
    with pytest.raises(InvalidMeshError, match=r"The other mesh: .* must be arrays of numbers"):
        match(straight, faces, [[0, 0, 0], [1, 0]], [[0, 1, 0]], DRAFT)


def test_chosen_feature_points_are_of_the_first_mesh(poses):
    (straight, faces), (bent, bent_faces, _) = poses
    coarse = coarsened(bent, bent_faces, len(bent) // 2)
    chosen = [*feature_patches(straight, faces, DRAFT).feature_points.tolist()]
    assert max(chosen) >= len(coarse.kept)
    chosen_settings = replace(DRAFT, feature_points=tuple(chosen))
    found = match(straight, faces, bent[coarse.kept], coarse.faces, chosen_settings)
    assert (found.vertices >= 0).all()


@pytest.mark.parametrize(
    ("one", "two"),
    [
        ("man/dance1_00", "man/walk1_04"),
        ("horse/bind", "horse/horse_gallop_f00"),
        ("man/rest", "woman/walk1_04"),
        ("bear/bind", "bear/bear_run_f12"),
    ],
)
def test_real_bodies_of_other_triangles_are_matched(one, two, real_mesh):
    vertices, faces = real_mesh(f"{one}.obj")
    whole, whole_faces = real_mesh(f"{two}.obj")
    fewer = coarsened(whole, whole_faces, int(0.7 * len(whole)))
    other, other_faces, _ = shapes.permuted(whole[fewer.kept], fewer.faces)
    found = match(vertices, faces, other, other_faces)
    off = np.linalg.norm(places(found, other) - whole, axis=1) / np.sqrt(surface_area(whole, whole_faces))
    assert off.mean() < 0.025
    assert np.mean(off > 0.2) < 0.01  # no flips
    assert "match_unlike" not in [each.kind for each in found.warnings]
