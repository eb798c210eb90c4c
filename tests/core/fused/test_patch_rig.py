"""Bodies as rigs of patches."""

import numpy as np
import pytest

from addon.core.fused.patch_rig import patch_rig
from addon.core.mesh.geometry import surface_area
from tests.meshes.animals import walker


@pytest.fixture(scope="module")
def body():
    vertices, faces = walker()
    return vertices / np.sqrt(surface_area(vertices, faces)), faces


@pytest.mark.parametrize("count", [1, 8, 60])
def test_patches_are_one_tree_and_hold_all_skin(body, count):
    rig = patch_rig(body[0], body[1], body[0], count)
    bones = rig.skeleton
    assert len(bones.names) == count
    assert (bones.parents < np.arange(count)).all()  # each after that above it
    assert (bones.parents >= 0).sum() == count - 1
    np.testing.assert_allclose(rig.weights.sum(axis=1), 1)
    shares = np.bincount(rig.weights.argmax(axis=1), minlength=count) / len(body[0])
    assert shares.min() > 0.2 / count
    np.testing.assert_array_equal(rig.mates, np.arange(count))
    assert not rig.is_human


def test_bones_begin_at_the_border_of_their_patches(body):
    rig = patch_rig(body[0], body[1], body[0], 24)
    held = rig.weights.argmax(axis=1)
    for bone, above in enumerate(rig.skeleton.parents):
        if above >= 0:
            both = body[0][(held == bone) | (held == above)]
            assert (rig.skeleton.heads[bone] > both.min(axis=0) - 1e-9).all()
            assert (rig.skeleton.heads[bone] < both.max(axis=0) + 1e-9).all()


def test_more_patches_than_vertices():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    rig = patch_rig(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), corners, 60)
    assert len(rig.skeleton.names) == 4


def test_parts_of_a_rig_keep_their_kind(body):
    rig = patch_rig(body[0], body[1], body[0], 8)
    half = rig.at(np.arange(100), np.array([[0, 1, 2]]))
    np.testing.assert_array_equal(half.mates, np.arange(8))
