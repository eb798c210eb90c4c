"""The mannequin in other proportions: bodies with large heads, short limbs and stout trunks, as artists draw them."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from .bone_fit import BoneFit, stretches
from .reference_rig import ReferenceRig
from .skeleton import Skeleton

Build = dict[str, tuple[float, float]]  # how much longer and wider a part is than the adult's

BUILDS: dict[str, Build] = {
    "figure": {  # a child, or a figure of five heads
        "head": (1.9, 1.9),
        "neck": (0.8, 1.2),
        "trunk": (0.95, 1.1),
        "arm": (0.8, 1.1),
        "leg": (0.7, 1.15),
    },
    "stocky": {  # a dwarf, or a body in thick clothes
        "head": (1.5, 1.5),
        "neck": (0.7, 1.2),
        "trunk": (0.9, 1.35),
        "arm": (0.85, 1.4),
        "hand": (1.2, 1.2),
        "leg": (0.7, 1.45),
        "foot": (1.2, 1.2),
    },
    "chibi": {  # half of it head
        "head": (3.0, 3.0),
        "neck": (0.5, 1.2),
        "trunk": (0.9, 1.25),
        "arm": (0.6, 1.3),
        "hand": (0.9, 0.9),
        "leg": (0.45, 1.4),
    },
}
_PARTS = {
    "spine": "trunk",
    "spine.001": "trunk",
    "spine.002": "trunk",
    "spine.003": "trunk",
    "spine.004": "neck",
    "spine.006": "head",
    "upper_arm": "arm",
    "forearm": "arm",
    "hand": "hand",
    "thigh": "leg",
    "shin": "leg",
    "foot": "foot",
    "toe": "foot",
}


def scales_of(rig: ReferenceRig, build: Build) -> FloatArray:
    """List by how much each bone is longer and wider in a build, (b, 2)."""
    stems = [name.removesuffix(".L").removesuffix(".R") for name in rig.skeleton.names]
    return np.array([build.get(_PARTS.get(stem, ""), (1.0, 1.0)) for stem in stems])


def reshaped(rig: ReferenceRig, scales: FloatArray) -> ReferenceRig:
    """Change the proportions of a reference: bones longer, their skin wider, joints carried along.

    `scales` (b, 2): along each bone and across it.

    Examples
    --------
    >>> from addon.core.modelling.mannequins import mannequin
    >>> from addon.core.rigging.reference_rig import mannequin_rig
    >>> rig = mannequin_rig(*mannequin())
    >>> child = reshaped(rig, scales_of(rig, BUILDS["figure"]))
    >>> bool(np.ptp(child.vertices[:, 2]) < np.ptp(rig.vertices[:, 2]))
    True
    """
    bones, stretch = rig.skeleton, stretches(rig.axes, scales)
    heads = bones.heads.copy()
    for bone, parent in enumerate(bones.parents):
        if parent >= 0:
            heads[bone] = heads[parent] + stretch[parent] @ (bones.heads[bone] - bones.heads[parent])
    tails = heads + np.einsum("bij,bj->bi", stretch, bones.tails - bones.heads)
    fit = BoneFit(heads, tails, np.broadcast_to(np.eye(3), (len(heads), 3, 3)), scales)
    return rig._replace(
        vertices=fit.posed(rig, rig.vertices, rig.weights), skeleton=Skeleton(bones.names, bones.parents, heads, tails)
    )
