"""Draws T-poses: one that is right, the same flipped front to back, and a body that is refused."""

import textwrap

import numpy as np
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from addon.core import CanonicalFormError, KeptStages, mannequin, stance_by_match
from addon.core.rigging.proportions import BUILDS, reshaped, scales_of
from addon.core.rigging.reference_rig import mannequin_rig
from addon.core.rigging.skeleton import skinned
from tests.meshes import shapes
from tests.meshes.bent_rigs import posed
from tools.figures.drawing import show

STRIDE = {  # degrees about the axes of the body
    "spine": (6, 0, 25), "spine.003": (0, 0, 15), "upper_arm.L": (0, 60, 15), "forearm.L": (0, 0, -70),
    "upper_arm.R": (0, -20, 55), "forearm.R": (0, 30, 60), "thigh.L": (-55, 0, 0), "shin.L": (65, 0, 0),
    "thigh.R": (20, 8, 0), "shin.R": (25, 0, 0),
}  # fmt: skip
FRONT = Rotation.from_euler("yx", [-25, 90], degrees=True).as_matrix()  # seen from the front, a little from its left


def draw(_models):
    """Draw a figure in stride, its T-pose, that flipped, and a bent tube, which is refused."""
    vertices, faces = figure_in_stride()
    keep = KeptStages()
    first = stance_by_match(vertices, faces, keep=keep)
    flipped = stance_by_match(vertices, faces, side=1, anyway=True, keep=keep)
    tube, triangles = shapes.joint(50.0)
    try:
        stance_by_match(tube, triangles)
        sentence = ""
    except CanonicalFormError as error:
        sentence = str(error)
    columns = [
        (vertices, faces, "in stride", ""),
        (first.vertices, first.faces, "T-Pose", ""),
        (flipped.vertices, flipped.faces, "Flip Front/Back", "toes and elbows are those of the back"),
        (tube, triangles, "refused", "\n".join(textwrap.wrap(sentence, 44))),
    ]
    figure = Figure(figsize=(2.4 * len(columns), 3.2), layout="constrained")
    for axes, (points, shown, title, under) in zip(figure.subplots(1, len(columns)), columns, strict=True):
        show(axes, points, shown, FRONT, title=title, under=under)
    return figure, {"costs": np.round(first.match.sides, 1).tolist(), "bones": min(first.bones.values())}


def figure_in_stride():
    """Pose the mannequin with a large head."""
    adult = mannequin_rig(*mannequin())
    rig = reshaped(adult, scales_of(adult, BUILDS["figure"]))
    return skinned(rig.vertices, rig.weights, posed(rig, STRIDE)), rig.faces
