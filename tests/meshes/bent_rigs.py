"""Rigs whose joints are bent by known angles."""

import numpy as np
from scipy.spatial.transform import Rotation

from addon.core.rigging.skeleton import BoneMotions


def posed(rig, bends):
    """The motions of the bones after some are bent, by name, in degrees about the axes of the body."""
    skeleton = rig.skeleton
    turns, heads = np.empty((len(skeleton.names), 3, 3)), skeleton.heads.copy()
    for bone, (name, above) in enumerate(zip(skeleton.names, skeleton.parents, strict=True)):
        turns[bone] = Rotation.from_euler("xyz", bends.get(name, (0, 0, 0)), degrees=True).as_matrix()
        if above >= 0:
            turns[bone] = turns[above] @ turns[bone]
            heads[bone] = heads[above] + turns[above] @ (skeleton.heads[bone] - skeleton.heads[above])
    return BoneMotions(skeleton.heads, heads, turns)
