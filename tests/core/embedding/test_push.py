"""The push that pulls limbs straight."""

import numpy as np
import pytest

from addon.core.embedding.push import far_pairs, wanting_far
from addon.core.mesh.edges import vertex_pairs
from addon.core.mesh.geometry import surface_area
from addon.core.stress.majorisation import Majorisation
from addon.core.stress.pairs import Pairs, length
from tests.meshes import shapes


@pytest.fixture
def tube():
    vertices, faces = shapes.bent_tube()
    return vertices / np.sqrt(surface_area(vertices, faces)), faces


def test_pushing_apart_straightens_a_bent_tube(tube):
    vertices, faces = tube
    count = len(vertices)
    ends = vertex_pairs(faces)
    edges = Pairs(ends, np.ones(len(ends)), count)
    far = far_pairs(np.arange(0, count, 20), [], 0.0, 0.5, count)
    terms = [edges.wanting_lengths(length(edges.apart(vertices))), wanting_far(far)]
    form, history = Majorisation(terms).lowered(vertices, 2000, tolerance=1e-6)
    assert (np.diff(history) <= 0).all()
    assert np.median(np.abs(length(edges.apart(form)) / length(edges.apart(vertices)) - 1)) < 0.12
    assert np.linalg.norm(np.ptp(form, axis=0)) > 1.2 * np.linalg.norm(np.ptp(vertices, axis=0))


def test_a_push_without_depth_leaves_the_third_axis_alone(tube):
    vertices, faces = tube
    count = len(vertices)
    ends = vertex_pairs(faces)
    edges = Pairs(ends, np.ones(len(ends)), count)
    far = wanting_far(far_pairs(np.arange(0, count, 20), [], 0.0, 3.0, count), 0.0)
    flat = vertices * [1.0, 1.0, 0.0]
    terms = [edges.wanting_lengths(length(edges.apart(vertices))), far]
    assert np.abs(Majorisation(terms).lowered(flat, 20)[0][:, 2]).max() < 1e-12
    deep = np.random.default_rng(0).normal(size=(count, 3))
    wanted = far.wants(far.pairs.apart(deep), deep)
    np.testing.assert_allclose(wanted[:, 2], far.pairs.apart(deep)[:, 2])  # what they have
    np.testing.assert_allclose(length(wanted * [1, 1, 0]), 10.0)


def test_ends_share_the_push_and_each_gets_as_much():
    landmarks, ends = np.array([0, 1]), [np.array([2, 3]), np.array([1, 4])]
    pairs = far_pairs(landmarks, ends, 0.5, 1.0, 5)
    assert 10 * pairs.weight.sum() == pytest.approx(1.0)
    assert pairs.ends.tolist() == [[0, 1], [2, 0], [2, 1], [3, 0], [3, 1], [1, 0], [4, 0]]
    np.testing.assert_allclose(10 * pairs.weight, [0.5, *[0.25 / 4] * 4, *[0.25 / 2] * 2])
