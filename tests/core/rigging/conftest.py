"""A rig drawn by hand: a trunk, and arms and legs that hang as one likes."""

import numpy as np
import pytest

from addon.core import Skeleton

SEGMENTS = ("shoulder", "upper_arm", "forearm", "hand", "thigh", "shin", "foot")


def turned_about_y(angle):
    cos, sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])


def hand_drawn(arms=45.0, elbow=0.0, knee=0.0, spread=0.0, names="{}.{}"):
    """A rig whose arms are lowered, elbows bent forward, knees bent back, legs spread, by degrees."""
    bones = [
        ("hips", -1, [0, 0, 1], [0, 0, 1.2]),
        ("chest", 0, [0, 0, 1.2], [0, 0, 1.6]),
        ("head", 1, [0, 0, 1.6], [0, 0, 2]),
    ]
    for letter, side in (("L", 1.0), ("R", -1.0)):
        down, bent, out = (np.radians(each) for each in (arms, elbow, spread))
        at, start = np.array([side * 0.2, 0, 1.5]), len(bones)
        along = np.array([side * np.cos(down), 0, -np.sin(down)])
        fore = np.cos(bent) * along + np.sin(bent) * np.array([0, -1.0, 0])
        bones += [
            (names.format("shoulder", letter), 1, [0, 0, 1.5], at),
            (names.format("upper_arm", letter), start, at, at + 0.3 * along),
            (names.format("forearm", letter), start + 1, at + 0.3 * along, at + 0.3 * along + 0.3 * fore),
            (names.format("hand", letter), start + 2, at + 0.3 * along + 0.3 * fore, at + 0.3 * along + 0.4 * fore),
        ]
        hip, start = np.array([side * 0.1, 0, 1]), len(bones)
        leg = np.array([side * np.sin(out), 0, -np.cos(out)])
        back = np.radians(knee)
        shin = np.cos(back) * leg + np.sin(back) * np.array([0, 1.0, 0])
        ankle = hip + 0.5 * leg + 0.4 * shin
        bones += [
            (names.format("thigh", letter), 0, hip, hip + 0.5 * leg),
            (names.format("shin", letter), start, hip + 0.5 * leg, ankle),
            (names.format("foot", letter), start + 1, ankle, ankle - [0, 0.15, 0.05]),
        ]
    called, parents, heads, tails = zip(*bones, strict=True)
    return Skeleton(list(called), np.array(parents), np.array(heads, float), np.array(tails, float))


@pytest.fixture
def drawn_rig():
    return hand_drawn
