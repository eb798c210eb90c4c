"""Made-up dolls of balls, capsules, plates and cloth: one body, and what was joined stays joined.

``CANONICAL_FORM_EXAMPLES=2000`` makes the run long.
"""

import os

import numpy as np
import pytest
from scipy.spatial import KDTree

from addon.core import Settings, canonical_form
from addon.core.mesh.geometry import of_unit_area
from tests.meshes import shapes

MANY = int(os.environ.get("CANONICAL_FORM_EXAMPLES", "12"))
QUICK = Settings(quality="draft")
BALL = shapes.sphere(3)
ANCHORS = {  # on a trunk from 0 to 1.5: where a limb begins, and the way it goes
    "head": ([0, 0, 1.5], [0, 0, 1.0]),
    "left arm": ([0.3, 0, 1.25], [1.0, 0, 0]),
    "right arm": ([-0.3, 0, 1.25], [-1.0, 0, 0]),
    "left leg": ([0.18, 0, 0.05], [0.1, 0, -1.0]),
    "right leg": ([-0.18, 0, 0.05], [-0.1, 0, -1.0]),
}
BEND = 0.25  # of each part of a limb, in radians: limbs that cross may be joined where they cross
TIGHT, APART = 0.012, 0.03  # gap of a joint before, and after, in sqrt(area)


def capsule(radius, start, end, flat=1.0):
    """A ball pulled apart between two places, thinner along y if it is flat."""
    vertices, faces = BALL
    way = np.subtract(end, start)
    along = way / np.linalg.norm(way)
    across = np.linalg.svd(along[None])[2][1:]
    own = vertices @ np.vstack([across * radius, along * radius])
    own[:, 1] *= flat
    return own + np.where((vertices[:, 2:] > 0), end, start), faces


def doll_of(seed):
    """Make pieces (vertices, faces), and the pairs of them that are joined."""
    rng = np.random.default_rng(seed)
    pieces, joined = [capsule(0.3, [0, 0, 0.2], [0, 0, 1.25], rng.choice([0.6, 1.0]))], []
    for name, (anchor, direction) in ANCHORS.items():
        place, way, before = np.array(anchor, dtype=float), np.array(direction), 0
        radius = rng.uniform(0.08, 0.12)
        for _ in range(1 if name == "head" else rng.integers(1, 4)):
            kind = rng.choice(["ball", "overlap", "plate"])
            if kind == "ball":
                pieces.append((1.1 * radius * BALL[0] + place, BALL[1]))
                joined.append((before, len(pieces) - 1))
                before = len(pieces) - 1
            turn = rng.uniform(-BEND, BEND, 3)
            way = way / np.linalg.norm(way) + turn
            way /= np.linalg.norm(way)
            length = 0.2 if name == "head" else rng.uniform(0.35, 0.6)
            end = place + length * way
            thick = 2.0 * radius if name == "head" else radius
            pieces.append(capsule(thick, place, end, 0.5 if kind == "plate" else 1.0))
            joined.append((before, len(pieces) - 1))
            before, place = len(pieces) - 1, end
        if name != "head" and rng.random() < 0.5:  # cloth around the last part
            vertices, faces = shapes.cylinder(16, 12, 1.3 * radius, 0.5 * length)
            across = np.linalg.svd(way[None])[2][1:]
            pieces.append((vertices @ np.vstack([across, way]) + place - 0.5 * length * way, faces))
    return pieces, joined


@pytest.mark.parametrize("seed", range(MANY))
def test_a_doll_is_one_body_and_its_joints_hold(seed):
    pieces, joined = doll_of(seed)
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    vertices = np.concatenate([each for each, _ in pieces])
    faces = np.concatenate([own + start for (_, own), start in zip(pieces, starts[:-1], strict=True)])
    form = canonical_form(vertices, faces, QUICK)
    assert np.isfinite(form.vertices).all()
    assert len(form.bodies) == 1
    unit = of_unit_area(vertices, faces)[2]
    for one, other in joined:
        first, second = (np.arange(starts[each], starts[each + 1]) for each in (one, other))
        before, after = (
            KDTree(points[first]).query(points[second])[0].min() / unit for points in (vertices, form.vertices)
        )
        assert before > TIGHT or after < APART
