"""Closed tubes whose axis is bent in several ways."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tests.meshes.shapes import Mesh, cylinder

LENGTH, RADIUS = 4.0, 0.12
HELIX_TURNS, HELIX_RADIUS = 1.5, 3 * RADIUS
Curve = Callable[[np.ndarray], np.ndarray]


def circle(degrees: float) -> Curve:
    """Bend an axis evenly by an angle."""
    return lambda along: turned(along, np.full(len(along), np.radians(degrees) / LENGTH))


def double_bend(along: np.ndarray) -> np.ndarray:
    """Bend an axis by half a circle to one side, then to the other."""
    return turned(along, np.where(along < LENGTH / 2, 1.0, -1.0) * 2 * np.pi / LENGTH)


def helix(along: np.ndarray) -> np.ndarray:
    """Wind an axis around a cylinder."""
    angle = HELIX_TURNS * 2 * np.pi / LENGTH * along
    rise = np.sqrt(1 - (HELIX_RADIUS * HELIX_TURNS * 2 * np.pi / LENGTH) ** 2)
    return np.column_stack([HELIX_RADIUS * np.cos(angle), HELIX_RADIUS * np.sin(angle), rise * along])


def turned(along: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """Integrate a plane curve from its curvature."""
    steps = np.diff(along)
    angle = np.concatenate([[0.0], np.cumsum(steps * (curvature[1:] + curvature[:-1]) / 2)])
    middle = (angle[1:] + angle[:-1]) / 2
    points = np.cumsum(steps[:, None] * np.column_stack([np.cos(middle), np.sin(middle)]), axis=0)
    return np.column_stack([np.concatenate([np.zeros((1, 2)), points]), np.zeros(len(along))])


CURVES: dict[str, Curve] = {
    "straight": circle(0.0),
    "quarter of a circle": circle(90.0),
    "half": circle(180.0),
    "three quarters": circle(270.0),
    "S": double_bend,
    "helix": helix,
}


def tube(curve: Curve, around: int, along: int) -> Mesh:
    """Make a closed tube around an axis, its rings turned as little as possible."""
    place = np.linspace(0, LENGTH, along + 1)
    axis = curve(place)
    tangent = np.gradient(axis, place, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    across = np.zeros_like(tangent)
    side = np.array([0.3, 0.5, 0.8])
    for number, way in enumerate(tangent):
        side = side - (side @ way) * way
        side /= np.linalg.norm(side)
        across[number] = side
    angle = 2 * np.pi * np.arange(around) / around
    out = np.cos(angle)[:, None] * across[:, None] + np.sin(angle)[:, None] * np.cross(tangent, across)[:, None]
    ring = np.arange(around)
    here = (around * np.arange(along)[:, None] + ring).ravel()
    beside = (around * np.arange(along)[:, None] + (ring + 1) % around).ravel()
    middles = around * (along + 1) + np.arange(2)
    last = around * along + ring
    faces = [
        np.column_stack([here, beside, here + around]),
        np.column_stack([beside, beside + around, here + around]),
        np.column_stack([ring, np.full(around, middles[0]), np.roll(ring, -1)]),
        np.column_stack([last, np.roll(last, -1), np.full(around, middles[1])]),
    ]
    points = axis[:, None] + RADIUS * out
    return np.concatenate([points.reshape(-1, 3), axis[[0, -1]]]), np.concatenate(faces)


def rings(vertices: np.ndarray, around: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the centres and girths of the rings of a tube."""
    each = vertices[:-2].reshape(-1, around, 3)
    return each.mean(axis=1), np.linalg.norm(each - np.roll(each, 1, axis=1), axis=2).sum(axis=1)


def length_of(axis: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(axis, axis=0), axis=1).sum())


def akimbo() -> Mesh:
    """Make an arm for a ball of radius 12 around the origin: one end sunk into it, the other lying on it, below."""
    vertices, faces = cylinder(24, 80, 1.0, np.pi)
    along = np.interp(vertices[:, 2], [vertices[:, 2].min(), vertices[:, 2].max()], [0, np.pi])
    end = np.minimum(1.0, 4 * np.minimum(along, np.pi - along))
    width = np.maximum(np.sqrt(1 - (1 - end) ** 2), 0.02)  # round ends
    angle, out = along - np.pi / 2 + 0.3, 4 + width * vertices[:, 0]
    ring = np.column_stack([out * np.cos(angle), out * np.sin(angle), width * vertices[:, 1]])
    return ring + np.array([12 - 1.405, 0.0, 0.0]), faces
