"""From the space of a mesh to that of a text file: .obj, .ply or .off."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..core.numerics.arrays import FloatArray
    from .wanted import Wanted

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}  # in metres
_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # images of X, Y and Z of the scene, as in most .obj files


def axes_of(kind: str) -> FloatArray:
    """Return the usual rotation from the axes of a scene to those of a kind of file, for row vectors, (3, 3)."""
    return _Y_UP if kind == "obj" else np.eye(3)


def in_file_space(form: FloatArray, placement: FloatArray, wanted: Wanted, metres: float = 1.0) -> FloatArray:
    """Transform a form from the space of its mesh to that of the file.

    `form` (n, 3); `placement`: that of the mesh in the scene, (4, 4), for column vectors; `metres`: a unit of the
    scene.
    """
    if wanted.space == "world":
        axes = axes_of(wanted.format) if wanted.axes is None else wanted.axes
        form = (form @ placement[:3, :3].T + placement[:3, 3]) @ axes
    return form if wanted.units is None else np.asarray(form * (metres / UNITS[wanted.units]))


def is_mirrored(placement: FloatArray, wanted: Wanted) -> bool:
    """Return whether faces are seen from behind in the space of the file, so that their corners are to be reversed."""
    return wanted.space == "world" and bool(np.linalg.det(placement[:3, :3]) < 0)
