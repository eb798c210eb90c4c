"""Animals made by formulas."""

import numpy as np

from .shapes import Limb, Mesh, limbed


def giraffe(neck: float = 0.0, cells: int = 60) -> Mesh:
    """A body on four long legs, its long neck leant to one side by an angle in radians."""
    trunk: Limb = (((-1.1, 0, 0), (1.0, 0, 0.1)), 0.42)
    aside, up = 2.2 * np.sin(neck), 0.5 + 2.2 * np.cos(neck)
    throat: Limb = (((0.9, 0, 0.1), (1.3, 0, 0.5), (1.5, aside / 2, 0.25 + up / 2), (1.8, aside, up)), 0.3)
    tail: Limb = (((-1.1, 0, 0), (-1.6, 0, -0.3), (-1.9, 0, -1.0)), 0.22)
    legs: list[Limb] = [
        (((place, 0, 0), (place, 0.8 * side, -0.1), (place, side, -2.5)), 0.2)
        for place in (-0.9, 0.9)
        for side in (-0.45, 0.45)
    ]
    return limbed([trunk, throat, tail, *legs], np.array([-3.2, -2.4, -2.8]), np.array([3.2, 2.4, 3.6]), cells)


def walker(swing: float = 0.0, cells: int = 70) -> Mesh:
    """A body on four legs; fore and hind leg of its right are swung towards each other by an angle in radians."""
    trunk: Limb = (((-1.0, 0, 0), (1.0, 0, 0.1)), 0.4)
    throat: Limb = (((0.9, 0, 0.1), (1.5, 0, 0.9), (2.1, 0, 1.0)), 0.26)
    tail: Limb = (((-1.0, 0, 0.1), (-1.8, 0, 0.2), (-2.3, 0, -0.3)), 0.16)
    legs: list[Limb] = []
    for place in (-0.95, 0.95):
        for side in (-0.4, 0.4):
            along = -np.sign(place) * 2.0 * np.sin(swing) if side < 0 else 0.0
            down = 2.0 * np.cos(swing) if side < 0 else 2.0
            hip = (place, side, -0.1)
            legs.append(((hip, (place + along / 2, side * 1.2, -down / 2), (place + along, side * 1.2, -down)), 0.2))
    low, high = np.array([-2.9, -1.3, -2.6]), np.array([2.9, 1.3, 1.7])
    return limbed([trunk, throat, tail, *legs], low, high, cells)
