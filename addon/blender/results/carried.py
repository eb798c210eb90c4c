"""What a match shows on a mesh; told without Blender."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...core.numerics.arrays import FloatArray


class Carried(NamedTuple):
    """What a match shows on a mesh.

    Attributes
    ----------
    confidence : (n,) ndarray of float
        How sure the match of each vertex is, 0 to 1.
    colours : (n, 4) ndarray of float32
        Colours of the reference, carried over.
    """

    confidence: FloatArray
    colours: np.ndarray
