"""Many pieces as one body: who is part of it, who rides, where everything ends up."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from addon.core import Settings, canonical_form, distance_field, feature_patches
from addon.core.assembly.bodies import bodies_of
from addon.core.assembly.contacts import sampled
from addon.core.assembly.gathering import feature_numbers
from addon.core.limbs import limb_shapes
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.geometry import surface_area, vertex_areas
from tests.meshes import pieced, shapes


@pytest.fixture(scope="module")
def character():
    return pieced.character()


@pytest.fixture(scope="module")
def form(character):
    return canonical_form(character[2].vertices, character[2].faces)


def names_of(made, body):
    """Names of the parts and of the riders of a body."""
    parts = {name for name, own in made.pieces.items() if np.isin(own, body.vertices).any()}
    riders = {
        name for name, own in made.pieces.items() for rider in body.riders if np.isin(own, rider.piece.vertices).any()
    }
    return parts, riders


def test_a_head_and_a_hand_are_parts_of_the_body_and_a_shirt_and_an_eye_ride(character):
    made = character[2]
    (body,) = bodies_of(made.vertices, made.faces).bodies
    assert names_of(made, body) == ({"trunk", "head", "hand"}, {"shirt", "eye"})


def test_a_cut_figure_has_the_form_of_the_uncut_one(character, form):
    vertices, faces, made = character
    whole = canonical_form(vertices, faces)
    assert len(form.feature_points) == len(whole.feature_points)
    skin = np.concatenate([made.pieces[name] for name in ("trunk", "head", "hand")])
    weights = vertex_areas(made.vertices, made.faces)[skin]
    wanted = whole.vertices[made.source[skin]]
    rotation, shift = rigid_fit(form.vertices[skin], wanted, weights)
    off = np.linalg.norm(form.vertices[skin] @ rotation + shift - wanted, axis=1)
    assert np.sqrt(weights @ off**2 / weights.sum()) < 0.02 * np.sqrt(surface_area(vertices, faces))


def test_pieces_stay_where_they_lie_on_each_other(character, form):
    made = character[2]
    size = np.sqrt(surface_area(made.vertices, made.faces))
    for name in ("shirt", "eye"):
        own = made.pieces[name]
        others = made.faces[~np.isin(made.faces, own).any(axis=1)]
        samples = sampled(made.vertices / size, others, 0.004)
        distance, at = KDTree(samples.points).query(made.vertices[own] / size)
        near = distance < 0.02
        assert near.any()
        now = np.linalg.norm(form.vertices[own] / size - samples.on(form.vertices / size)[at], axis=1)
        assert np.quantile(np.abs(now - distance)[near], 0.95) < 0.006


def test_an_eye_keeps_its_shape(character, form):
    made = character[2]
    own = made.pieces["eye"]
    faces = made.faces[np.isin(made.faces, own).all(axis=1)]
    stretch = edge_stretch(made.vertices, form.vertices, faces)
    np.testing.assert_allclose(stretch, stretch[0], rtol=1e-6)
    assert len(set(form.patches[own])) == 1


def test_riders_have_the_patches_under_them_and_no_features(character, form):
    made = character[2]
    assert (form.patches >= 0).all()
    skin = np.concatenate([made.pieces[name] for name in ("trunk", "head", "hand")])
    assert np.isin(form.feature_points, skin).all()
    shirt = made.pieces["shirt"]
    under = np.flatnonzero(np.isin(made.source, made.source[shirt]) & (np.arange(len(made.source)) < shirt[0]))
    below = form.patches[under][np.argsort(made.source[under])]
    assert np.mean(form.patches[shirt][np.argsort(made.source[shirt])] == below) > 0.9


def test_apart_is_as_before(character):
    made = character[2]
    form = canonical_form(made.vertices, made.faces, Settings(pieces="apart"))
    assert form.warnings[0].kind == "several_pieces"
    own = made.pieces["head"]
    faces = made.faces[np.isin(made.faces, own).all(axis=1)] - own[0]
    np.testing.assert_array_equal(form.vertices[own], canonical_form(made.vertices[own], faces).vertices)


def test_motion_and_size_change_nothing(character, form, rotation):
    made = character[2]
    moved = canonical_form(5 * made.vertices @ rotation + 100, made.faces)
    np.testing.assert_allclose(moved.vertices, 5 * form.vertices @ rotation + 100, atol=1e-5 * 5 * 5)
    np.testing.assert_array_equal(moved.patches, form.patches)


def test_a_hand_that_touches_its_own_upper_arm_is_not_joined_to_it():
    """Bend a tube into a U whose sides touch, and cut the end of one side off."""
    vertices, faces = shapes.joint(175, 60, 24, 4.0, 0.37)
    middle = vertices[faces].mean(axis=1)
    made = pieced.cut(vertices, faces, {"hand": (middle[:, 0] < 0.6) & (middle[:, 1] > 0.39)})
    hand, arm = made.vertices[made.pieces["hand"]], made.vertices[made.pieces["trunk"]]
    beside = arm[(arm[:, 0] < 0.4) & (arm[:, 1] < 0.39)]
    assert KDTree(hand).query(beside)[0].min() < 0.025 * np.sqrt(surface_area(vertices, faces))
    (body,) = bodies_of(made.vertices, made.faces).bodies
    assert len(body.parts) == 2
    form = canonical_form(made.vertices, made.faces)
    end = form.vertices[made.pieces["hand"]].mean(axis=0)
    other = form.vertices[made.pieces["trunk"]][(arm[:, 0] < 0.4) & (arm[:, 1] < 0.39)].mean(axis=0)
    assert np.linalg.norm(end - other) > 2.0


def test_two_men_side_by_side_are_two_bodies(character):
    made = character[2]
    low, high = made.vertices.min(axis=0), made.vertices.max(axis=0)
    for gap in (-0.02, 0.0, 0.01, 1.0):
        beside = made.vertices + np.array([high[0] - low[0] + gap, 0, 0])
        two = np.vstack([made.vertices, beside])
        bodies = bodies_of(two, np.vstack([made.faces, made.faces + len(beside)]))
        assert [len(body.parts) for body in bodies.bodies] == [3, 3]
        assert [each.kind for each in bodies.apart] == ["several_bodies"]


def test_a_source_on_a_rider_and_distances_across_pieces(character):
    made = character[2]
    eye, hand = made.pieces["eye"][0], made.pieces["hand"]
    for kind in ("heat", "fast_marching", "biharmonic", "commute_time"):
        field = distance_field(made.vertices, made.faces, [eye], kind)
        assert np.isfinite(field).all()
        assert field[eye] == 0
        assert field[hand].mean() > field[made.pieces["head"]].mean()


def test_features_chosen_on_a_rider_stay_there(character):
    made = character[2]
    given = [int(made.pieces["eye"][5]), int(made.pieces["hand"][3])]
    found = feature_patches(made.vertices, made.faces, Settings(feature_points=given))
    np.testing.assert_array_equal(found.feature_points, given)
    np.testing.assert_array_equal(found.patches[given], [0, 1])


def test_half_way_and_one_limb_alone_take_the_riders_along(character, form):
    made = character[2]
    everything = np.ones(len(made.vertices), dtype=bool)
    half, whole = limb_shapes(made.vertices, made.faces, form.vertices, everything, ways=(0.5, 1.0))
    size = np.sqrt(surface_area(made.vertices, made.faces))
    assert np.abs(whole - form.vertices).max() < 0.02 * size
    eye, head = made.pieces["eye"], made.pieces["head"]
    for shape in (half, whole):
        before, _ = KDTree(made.vertices[head]).query(made.vertices[eye])
        after, _ = KDTree(shape[head]).query(shape[eye])
        assert np.abs(after - before).max() < 0.02 * size
    limb = form.patches == form.patches[made.pieces["hand"][0]]
    (shape,) = limb_shapes(made.vertices, made.faces, form.vertices, limb)
    np.testing.assert_allclose(shape[eye], made.vertices[eye], atol=1e-6 * size)


@pytest.mark.parametrize("method", ["classical", "fast", "as_published", "skeleton"])
def test_every_method_unfolds_bodies(character, method):
    made = character[2]
    form = canonical_form(made.vertices, made.faces, Settings(method=method, quality="draft", max_iterations=20))
    assert np.isfinite(form.vertices).all()
    assert len(form.feature_points) < 10


def test_it_does_not_depend_on_the_order_of_the_pieces(character, form):
    made = character[2]
    other = canonical_form(made.vertices, np.roll(made.faces, 300, axis=0))
    off = np.linalg.norm(other.vertices - form.vertices, axis=1)
    assert np.quantile(off, 0.95) < 0.05 * np.sqrt(surface_area(made.vertices, made.faces))


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_loose_vertices_far_away_do_not_matter(character, form):
    made = character[2]
    far = np.vstack([1e-22 * made.vertices, [[1.0, 1, 1]]])
    np.testing.assert_allclose(1e22 * canonical_form(far, made.faces).vertices[:-1], form.vertices, atol=1e-4)


def test_feature_points_of_several_bodies_are_numbered_body_by_body(figure):
    vertices, faces = figure
    alone = feature_patches(vertices, faces).feature_points
    beside = np.vstack([0.9 * vertices, vertices + np.array([50.0, 0, 0])])  # the larger body has the later vertices
    found = feature_patches(beside, np.vstack([faces, faces + len(vertices)]))
    np.testing.assert_array_equal(found.feature_points, [*(alone + len(vertices)), *alone])
    np.testing.assert_array_equal(found.patches[found.feature_points], np.arange(2 * len(alone)))
    bodies = bodies_of(beside, np.vstack([faces, faces + len(vertices)]))
    numbers = feature_numbers(bodies, [np.array([7, 3]), np.array([5, 1, 2])])  # whatever order they come in stays
    assert [each.tolist() for each in numbers] == [[0, 1], [2, 3, 4]]
    with pytest.raises(ValueError, match="argument 3 is longer"):
        feature_numbers(bodies, [np.array([7, 3])])
