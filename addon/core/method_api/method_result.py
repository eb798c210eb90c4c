"""What every way to unfold a surface gives."""

from __future__ import annotations

from dataclasses import dataclass

from ..numerics.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class MethodResult:
    """A form before it is scaled and aligned to its input.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        All vertices, of any size and in any place, outside out.
    history : (s + 1,) ndarray of float
        What is minimised, before each of the s steps and after the last; one value for a method without steps.
    pair_count : int
        Entries of the distance matrices that the method uses.
    """

    points: FloatArray
    history: FloatArray
    pair_count: int
