"""Values that show a match on a mesh; defined without Blender."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...core.numerics.arrays import FloatArray


class MatchValues(NamedTuple):
    """Values that show a match on a mesh.

    Attributes
    ----------
    confidence : (n,) ndarray of float
        Confidence of the match of each vertex, 0 to 1.
    colours : (n, 4) ndarray of float32
        Colours transferred from the reference.
    """

    confidence: FloatArray
    colours: np.ndarray
