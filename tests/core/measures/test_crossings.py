import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.core.measures.crossings import crossings
from tests.meshes import shapes


def test_a_shape_in_a_shape_crosses_where_their_surfaces_meet():
    ball, faces = shapes.sphere(3)
    both = np.concatenate([ball, ball + np.array([0.7, 0.03, 0.01])]), np.concatenate([faces, faces + len(ball)])
    pairs = crossings(*both)
    assert len(pairs) > 50
    assert ((pairs < len(faces)).sum(axis=1) == 1).all()
    middle = both[0][both[1][pairs]].mean(axis=(1, 2))
    np.testing.assert_allclose(middle[:, 0], 0.35, atol=0.15)  # the circle in which two balls meet


@pytest.mark.parametrize("apart", [[2.5, 0, 0], [0.0, 0, 0]])
def test_shapes_that_are_apart_or_coincide_do_not_cross(apart):
    ball, faces = shapes.sphere(2)
    assert crossings(np.concatenate([ball, ball + apart]), np.concatenate([faces, faces + len(ball)])).shape == (0, 2)


def test_neither_size_nor_place_matters():
    figure, faces = shapes.figure(11)
    folded = figure * [1, 1, 0.02]
    folded[:, 1] += 0.3 * np.sin(9 * figure[:, 0])
    folded = np.concatenate([folded, folded[:, [1, 0, 2]] + 0.01])
    both = np.concatenate([faces, faces + len(figure)])
    pairs = crossings(folded, both)
    assert len(pairs)
    np.testing.assert_array_equal(pairs, crossings(1e3 * folded + 5.0, both))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_they_are_those_that_blender_finds(seed):
    pytest.importorskip("bpy")
    from mathutils.bvhtree import BVHTree

    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 60))
    vertices = rng.normal(size=(count, 3)) * rng.choice([1.0, 5.0], size=3)
    faces = np.array([rng.choice(count, 3, replace=False) for _ in range(count)])
    known = {
        (one, two)
        for one, two in (sorted(pair) for pair in _overlap(BVHTree, vertices, faces))
        if not set(faces[one]) & set(faces[two])
    }
    assert {tuple(pair) for pair in crossings(vertices, faces).tolist()} == known


def _overlap(tree, vertices, faces):
    made = tree.FromPolygons(vertices.tolist(), faces.tolist(), all_triangles=True)
    return made.overlap(made)
