"""A body of any kind as a rig: patches of its skin as bones, by which it bends, without a skeleton of its own."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import vertex_pairs
from ..mesh.far_points import far_points
from ..mesh.geometry import vertex_areas
from ..numerics.arrays import FloatArray, IntArray
from ..rigging.reference_rig import ReferenceRig, diffused
from ..rigging.skeleton import Skeleton

_ROUNDS = 5  # of moving the middles of patches
_SOFT = 0.06  # diffusion time of the weights, in areas of a patch
_LEAST = 1e-3  # of sqrt(area): length of a bone whose patch lies about its own joint


class PatchRig(ReferenceRig):
    """A body whose bones are patches: none is the counterpart of another."""

    __slots__ = ()

    @property
    def mates(self) -> IntArray:
        """For each bone itself, (b,)."""
        return np.arange(len(self.skeleton.names))


def patch_rig(points: FloatArray, faces: IntArray, form: FloatArray, count: int) -> PatchRig:
    """Divide a body into patches that are bones, each joined to the one with which it has the longest border.

    Patches are even on the form, where limbs that touch in the pose lie apart.

    `points` (n, 3), `faces` (m, 3): a connected surface of unit area; `form` (n, 3): its form; `count`: of patches.

    Examples
    --------
    >>> from addon.core import mannequin
    >>> vertices, faces = mannequin()
    >>> rig = patch_rig(vertices, faces, vertices, 8)
    >>> len(rig.skeleton.names), int((rig.skeleton.parents < 0).sum()), bool(np.allclose(rig.weights.sum(axis=1), 1))
    (8, 1, True)

    References
    ----------
    Sumner, Schmid and Pauly, "Embedded deformation for shape manipulation", 2007, doi:10.1145/1276377.1276478.
    """
    areas = vertex_areas(points, faces)
    patch = _even_patches(form, areas, count)
    count = int(patch.max()) + 1
    pairs = vertex_pairs(faces)
    across = patch[pairs]  # (e, 2)
    border = across[:, 0] != across[:, 1]
    order, parents = _tree(across[border], np.bincount(patch, areas, count))
    number = np.argsort(order)
    middles = np.array([points[patch == each].mean(axis=0) for each in order])
    heads = middles - [0.0, 0.0, _LEAST]
    for bone, above in enumerate(parents):
        if above >= 0:
            both = border & (np.sort(number[across], axis=1) == sorted((bone, above))).all(axis=1)
            heads[bone] = points[pairs[both].ravel()].mean(axis=0)
    hard = np.eye(count)[number[patch]]
    skeleton = Skeleton([f"patch {each}" for each in range(count)], parents, heads, middles)
    return PatchRig(points, faces, skeleton, diffused(points, faces, hard, _SOFT / count))


def _even_patches(form: FloatArray, areas: FloatArray, count: int) -> IntArray:
    """Divide vertices into patches of like extent, (n,): the farthest from the others, moved to their middles."""
    from scipy.spatial import cKDTree

    chosen, vertices = far_points(form, count), cKDTree(form)
    for _ in range(_ROUNDS):
        patch = cKDTree(form[chosen]).query(form)[1]
        own = [patch == each for each in np.unique(patch)]
        middles = [areas[each] @ form[each] / max(areas[each].sum(), np.finfo(float).tiny) for each in own]
        chosen = vertices.query(middles)[1]
    patch = cKDTree(form[chosen]).query(form)[1]
    return np.unique(patch, return_inverse=True)[1].astype(np.int64)


def _tree(borders: IntArray, areas: np.ndarray) -> tuple[IntArray, IntArray]:
    """Join patches into a tree by their longest borders, from the largest outwards.

    `borders` (e, 2): the patches on either side of each edge; `areas` (p,); gives the patches in their order, (p,), and
    the number in it of the one above each, -1 for none.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    count = len(areas)
    ends = np.sort(borders, axis=1)
    kinds, lengths = np.unique(ends, axis=0, return_counts=True)
    tree = minimum_spanning_tree(coo_matrix((1.0 / lengths, kinds.T), shape=(count, count)).tocsr())
    order, above = breadth_first_order(tree, int(areas.argmax()), directed=False)
    parents = np.append(np.argsort(order), -1)[np.maximum(above[order], -1)]  # the last is of none
    return order.astype(np.int64), parents
