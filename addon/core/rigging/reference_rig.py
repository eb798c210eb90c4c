"""A rigged body that lends its skeleton to others, and the mannequin as one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.geometry import checked_arrays
from ..modelling.body_plan import SHOULDER
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.errors import InvalidMeshError
from .skeleton import Skeleton, mirror_name

_ELBOW, _WRIST, _TIPS = 0.27, 0.52, 0.615  # metres from the shoulder
_X, _Y, _Z = SHOULDER
_HIP_AT, _KNEE_AT = (0.106, 0.024, 0.93), (0.095, -0.01, 0.52)
_ELBOW_AT, _WRIST_AT = (_X + _ELBOW, _Y + 0.012, _Z + 0.01), (_X + _WRIST, _Y, _Z + 0.008)
_JOINTS = {  # of the left side and the middle, in Rigify's names: head, tail, parent
    "spine": ((0, 0.03, 0.92), (0, 0.03, 1.02), ""),
    "spine.001": ((0, 0.03, 1.02), (0, 0.03, 1.155), "spine"),
    "spine.002": ((0, 0.03, 1.155), (0, 0.035, 1.3), "spine.001"),
    "spine.003": ((0, 0.035, 1.3), (0, 0.035, 1.45), "spine.002"),
    "spine.004": ((0, 0.035, 1.45), (0, 0.015, 1.56), "spine.003"),
    "spine.006": ((0, 0.015, 1.56), (0, 0.015, 1.747), "spine.004"),
    "shoulder.L": ((0.02, -0.02, 1.42), (0.14, 0.02, 1.425), "spine.003"),
    "upper_arm.L": (SHOULDER, _ELBOW_AT, "shoulder.L"),
    "forearm.L": (_ELBOW_AT, _WRIST_AT, "upper_arm.L"),
    "hand.L": (_WRIST_AT, (_X + _TIPS, _Y, _Z), "forearm.L"),
    "thigh.L": (_HIP_AT, _KNEE_AT, "spine"),
    "shin.L": (_KNEE_AT, (0.1, 0.025, 0.085), "thigh.L"),
    "foot.L": ((0.1, 0.025, 0.085), (0.112, -0.1, 0.025), "shin.L"),
    "toe.L": ((0.112, -0.1, 0.025), (0.114, -0.175, 0.02), "foot.L"),
}
MANNEQUIN_BONES = tuple(dict.fromkeys(each for name in _JOINTS for each in (name, mirror_name(name))))
_PARTNERS = 0.03  # of the height: distance of the mirror image of a bone from its partner
_SOFT = 2e-4  # m²: diffusion time of the weights, about a hand's breadth across a joint
_COLLAR, _HIP, _KNEE = 0.075, 0.93, 0.52  # metres: where collarbones, thighs and shins begin


class ReferenceRig(NamedTuple):
    """A rigged body in a pose that is known: facing -Y, its left at +X, Z up.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Its skin.
    faces : (m, 3) ndarray of int
        Triangles.
    skeleton : Skeleton
        Its bones, in Rigify's names.
    weights : (n, b) ndarray of float
        How far each vertex follows each bone; rows sum to 1.
    """

    vertices: FloatArray
    faces: IntArray
    skeleton: Skeleton
    weights: FloatArray

    @property
    def axes(self) -> FloatArray:
        """Directions of the bones, (b, 3)."""
        return self.skeleton.axes

    @property
    def is_human(self) -> bool:
        """Whether its bones are those of the mannequin: two arms and two legs whose joints have limits."""
        return set(_JOINTS) <= set(self.skeleton.names)

    @property
    def mates(self) -> IntArray:
        """For each bone that of the other side, itself in the middle: by Blender's endings, else by where it lies."""
        bones, own = self.skeleton, np.arange(len(self.skeleton.names))
        names, place = bones.names, {name: bone for bone, name in enumerate(bones.names)}
        named = np.array([place.get(mirror_name(name), bone) for bone, name in enumerate(names)])
        found = np.where(named != own, named, self._mirrored())
        for bone in bones.downwards():  # what hangs on no pair, or on both of one, is none
            above, other = bones.parents[bone], bones.parents[found[bone]]
            if named[bone] == bone and above >= 0 and (other < 0 or found[above] != other):
                found[[bone, found[bone]]] = bone, found[bone]
        return found

    def _mirrored(self) -> IntArray:
        """For each bone the one whose mirror image it is, by head and tail; itself if there is none."""
        lie = np.hstack([self.skeleton.heads, self.skeleton.tails])  # (b, 6)
        skin = self.weights.any(axis=0)
        middle = float(np.median(self.skeleton.heads[skin, 0]))  # props on one side do not move it
        image = lie * [-1.0, 1, 1, -1, 1, 1] + 2 * middle * np.array([1.0, 0, 0, 1, 0, 0])
        apart = np.linalg.norm(image[:, None] - lie, axis=2)
        near, own = apart.argmin(axis=1), np.arange(len(lie))
        close = apart[own, near] < _PARTNERS * np.ptp(lie[:, :3], axis=0).max()
        return np.where(close & (near[near] == own), near, own)

    def at(self, vertices: IntArray, faces: IntArray) -> ReferenceRig:
        """Return the rig on some of its vertices, with triangles of their own. `vertices` (c,); `faces` (d, 3)."""
        return self._replace(vertices=self.vertices[vertices], faces=faces, weights=self.weights[vertices])


def checked_rig(reference: ReferenceRig) -> ReferenceRig:
    """Check a reference, and sort its bones, each after its parent."""
    points, triangles = checked_arrays(reference.vertices, reference.faces)
    names, *arrays = reference.skeleton
    parents, heads, tails, held = (np.asarray(each) for each in (*arrays, reference.weights))
    count = len(names)
    shapes = (parents.shape, heads.shape, tails.shape, held.shape)
    if (
        count == 0
        or shapes != ((count,), (count, 3), (count, 3), (len(points), count))
        or parents.dtype.kind != "i"
        or not all(np.isfinite(each).all() for each in (heads, tails, held))
        or not ((parents >= -1) & (parents < count)).all()
        or not (held >= 0).all()
        or any(bone in Skeleton(names, parents, heads, tails).ancestors(bone) for bone in range(count))
    ):
        raise InvalidMeshError("stance_arrays", bones=count, vertices=len(points))
    bones = Skeleton(list(names), parents, heads.astype(np.float64), tails.astype(np.float64))
    order = np.array(bones.downwards())
    new = np.append(np.argsort(order), -1)  # the parent of none is -1
    skeleton = Skeleton([bones.names[bone] for bone in order], new[bones.parents[order]], *bones[2:])
    skeleton = skeleton._replace(heads=skeleton.heads[order], tails=skeleton.tails[order])
    total = held.sum(axis=1, keepdims=True)
    root = np.eye(count)[0]  # holds what nothing holds
    held = np.where(total > 0, held[:, order] / np.maximum(total, np.finfo(float).tiny), root)
    return ReferenceRig(points, triangles, skeleton, held)


def mannequin_rig(vertices: FloatArray, faces: IntArray) -> ReferenceRig:
    """Give the mannequin a skeleton: Rigify's names, weights that change over a joint's width.

    `vertices, faces`: of the mannequin in its T-pose.

    Examples
    --------
    >>> from addon.core.modelling.mannequins import mannequin
    >>> rig = mannequin_rig(*mannequin())
    >>> len(rig.skeleton.names), bool(np.allclose(rig.weights.sum(axis=1), 1))
    (22, True)
    """
    names, parents, heads, tails = [], [], [], []
    for name, (head, tail, parent) in _JOINTS.items():
        for side, mine in ((1.0, name),) if mirror_name(name) == name else ((1.0, name), (-1.0, mirror_name(name))):
            above = mirror_name(parent) if side < 0 and mirror_name(parent) != parent else parent
            names.append(mine)
            parents.append(names.index(above) if above else -1)
            heads.append(np.multiply(head, (side, 1, 1)))
            tails.append(np.multiply(tail, (side, 1, 1)))
    skeleton = Skeleton(names, np.array(parents), np.array(heads), np.array(tails))
    segments = _segments(vertices)
    hard = np.zeros((len(vertices), len(names)))
    hard[np.arange(len(vertices)), [names.index(each) for each in segments]] = 1.0
    return ReferenceRig(vertices, faces, skeleton, diffused(vertices, faces, hard, _SOFT))


def diffused(vertices: FloatArray, faces: IntArray, values: FloatArray, time: float) -> FloatArray:
    """Smooth values over a surface by one step of the heat flow. `time`: in units of area; gives (n, d)."""
    from scipy.sparse import diags

    from ..surface.laplacian import stiffness_and_mass
    from ..surface.triangulation import triangulated

    stiffness, mass = stiffness_and_mass(triangulated(vertices, faces))
    smooth = factored(diags(mass) + time * stiffness).solve(mass[:, None] * values)
    smooth = np.maximum(smooth, 0.0)
    return np.asarray(smooth / smooth.sum(axis=1, keepdims=True))


def _segments(vertices: FloatArray) -> list[str]:
    """Name the bone that each vertex of the mannequin is nearest to, by planes across the joints."""
    x, y, z = vertices.T
    out, side = np.abs(x), np.where(x > 0, "L", "R")
    spine = np.searchsorted([1.02, 1.155, 1.3, 1.45, 1.565], z + np.where(z > 1.45, 0.3 * (y - 0.03), 0.0))
    found = np.array(["spine", "spine.001", "spine.002", "spine.003", "spine.004", "spine.006"], dtype="U12")[spine]
    collar = (out > _COLLAR) & (z > 1.36) & (z < 1.5)
    arm = (out > _X) & (z > 1.33) & (z < 1.56)
    legs = (z < _HIP - 0.25 * (out - 0.09)) & ~((out > 0.3) & (z > 0.5))
    for chosen, limb in (
        (collar, "shoulder"),
        (arm, "upper_arm"),
        (arm & (out > _X + _ELBOW), "forearm"),
        (arm & (out > _X + _WRIST), "hand"),
        (legs, "thigh"),
        (legs & (z < _KNEE), "shin"),
        (legs & (z + 0.35 * np.clip(y - 0.02, -0.05, 0.05) < 0.085), "foot"),
        (legs & (z < 0.12) & (y < -0.1), "toe"),
    ):
        found[chosen] = np.char.add(f"{limb}.", side[chosen])
    return found.tolist()


def hinges(rig: ReferenceRig) -> dict[str, FloatArray]:
    """Return the axis about which each elbow and knee bends, at rest: elbows forward, knees backward."""
    names, axes = rig.skeleton.names, rig.axes
    found = {}
    for name, forward in (("forearm", 1.0), ("shin", -1.0)):
        for side in "LR":
            axis = np.cross(axes[names.index(f"{name}.{side}")], [0.0, -forward, 0.0])
            found[f"{name}.{side}"] = axis / np.linalg.norm(axis)
    return found
