"""Bridges between the parts of a body."""

import numpy as np

from addon.core.assembly.bridges import bridges_between
from addon.core.assembly.contacts import sampled
from addon.core.mesh.geometry import of_unit_area

AROUND = 48


def turned(profile, lift):
    """A surface about the z axis through a profile of radii and heights, lifted by angle."""
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    rings = [np.column_stack([r * np.cos(angles), r * np.sin(angles), z + lift(angles)]) for r, z in profile]
    corners = [
        (row * AROUND + at, row * AROUND + (at + 1) % AROUND) for row in range(len(rings) - 1) for at in range(AROUND)
    ]
    faces = [face for i, j in corners for face in ((i, j, j + AROUND), (i, j + AROUND, i + AROUND))]
    return np.concatenate(rings), np.array(faces)


def neck_in_collar():
    """A neck whose flat shoulders lie under a collar in front and behind; at both sides the collar stands off."""
    slope, shoulders = 0.1, np.linspace(0.30, 0.08, 8)
    neck = [*((r, -slope * r) for r in shoulders), *((0.08, z) for z in np.linspace(0.03, 0.6, 16))]
    trunk = [*((0.5, z) for z in np.linspace(-1.5, -0.1, 30)), *((r, -slope * r) for r in np.linspace(0.46, 0.14, 10))]
    parts = [
        turned(neck, np.zeros_like),
        turned(trunk, lambda angle: 0.02 + 0.5 * np.maximum(np.abs(np.cos(angle)) - 0.9, 0)),
    ]
    faces = np.concatenate([parts[0][1], parts[1][1] + len(parts[0][0])])
    points = of_unit_area(np.concatenate([points for points, _ in parts]), faces)[0]
    part = np.repeat([0, 1], [len(points) for points, _ in parts])
    return points, faces, part, [sampled(points[part == at], parts[at][1]).points for at in (0, 1)]


def test_a_neck_that_its_collar_holds_in_front_and_behind_is_joined_on_both_sides():
    points, faces, part, surfaces = neck_in_collar()
    sides = points[np.unique(bridges_between(points, faces, part, surfaces)), 1]
    assert sides.min() < -0.05
    assert sides.max() > 0.05
