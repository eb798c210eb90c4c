"""What holds of any transfer: of split, masked and keyed sources, whatever the cuts."""

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.core import Match, match, transferred, transferred_corners, transferred_labels, transferred_shape
from tests.meshes.shapes import figure

EXAMPLES = int(os.environ.get("CANONICAL_FORM_EXAMPLES", "20"))


@pytest.fixture(scope="module")
def bodies():
    """A figure, another one with other triangles, and the match of the first with the second."""
    here, there = figure(11), figure(14)
    return here, there, match(*here, *there)


def split(points, faces, cut):
    """Give the faces of each label vertices of their own, as files do where normals or UV coordinates jump."""
    pairs = np.column_stack([faces.ravel(), np.repeat(cut, 3)])
    own, new = np.unique(pairs, axis=0, return_inverse=True)
    return points[own[:, 0]], new.reshape(-1, 3), own[:, 0]


def through(found, split_faces, points_there):
    """The same match, of a source that is split: as the match of the split mesh has it."""
    return Match(
        split_faces[found.faces, found.weights.argmax(axis=1)], found.faces, found.weights, found.confidence,
        found.sides, split_faces, len(points_there), {}, [], [],
    )  # fmt: skip


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 6), share=st.floats(0.0, 1.0))
@settings(max_examples=EXAMPLES, deadline=None)
def test_a_split_source_gives_what_the_whole_one_gives(bodies, seed, count, share):
    (points, faces), (others, other_faces), found = bodies
    rng = np.random.default_rng(seed)
    centres = others[other_faces].mean(axis=1) @ rng.normal(size=3)
    cut = np.searchsorted(np.quantile(centres, np.linspace(0, 1, count + 1)[1:-1]), centres)
    cut = np.where(rng.random(len(cut)) < share, rng.integers(0, count, len(cut)), cut)
    split_points, split_faces, source = split(others, other_faces, cut)
    parted = through(found, split_faces, split_points)
    values = rng.random((len(others), 3))  # weights, colours
    np.testing.assert_allclose(transferred(parted, values[source]), transferred(found, values), atol=1e-12)
    assert transferred(parted, values[source]).min() >= 0
    moved = others + rng.normal(size=3) + 0.1 * values  # a key
    np.testing.assert_allclose(
        transferred_shape(parted, points, faces, split_points, moved[source]),
        transferred_shape(found, points, faces, others, moved),
        atol=1e-9,
    )
    polygon_of, vertex_of = np.repeat(np.arange(len(faces)), 3), faces.ravel()
    labels = rng.integers(0, 4, len(other_faces))
    np.testing.assert_array_equal(
        transferred_labels(parted, polygon_of, vertex_of, split_faces, labels),
        transferred_labels(found, polygon_of, vertex_of, other_faces, labels),
    )
    corners = np.arange(3 * len(other_faces)).reshape(-1, 3)
    for uv in (values[other_faces.ravel()], np.full((corners.size, 2), 0.25)):
        own = transferred_corners(parted, polygon_of, vertex_of, split_points, corners, uv, split_faces.ravel())
        assert np.isfinite(own).all()
    np.testing.assert_allclose(own, 0.25, atol=1e-9)
