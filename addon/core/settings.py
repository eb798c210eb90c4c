"""The options of the method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .errors import InvalidSettingsError

STARTS = ("intrinsic", "input")


@dataclass(frozen=True)
class Settings:
    """Options of the canonical form; the defaults suit posed figures and animals.

    Attributes
    ----------
    diffusion_time : float
        t of the Auto Diffusion Function (equation 7), in multiples of 1/λ_1. Larger: fewer, broader features.
    eigenpairs : int
        Number K of eigenpairs in the Auto Diffusion Function and, as published, in the commute time.
    prominence : float
        Least prominence of a feature point: the logarithm of how many times higher the Auto Diffusion Function is
        there than at the pass to a higher point. Larger: fewer features.
    merge_distance : float
        Feature points closer than this share of the geodesic diameter become one, 0 to 1.
    feature_points : sequence of int, optional
        Vertices to use as feature points instead of those detected, in the order of their patches.
    start : {'intrinsic', 'input'}
        Where the minimisation starts: from landmark classical scaling, which knows the surface alone, or from the
        input, whose pose the result then keeps in part.
    landmarks : int
        Number of landmarks of the intrinsic start.
    feature_share : float
        How much the other feature points pull at a feature point, as a share of the weight with which its own patch
        holds it. Far above 0.1 they would pull spikes out of the surface.
    iterations : int
        Most majorisation steps.
    tolerance : float
        Stop when a step lowers the stress by less than this share of it.
    extrapolation : int
        Number of earlier steps from which the next is extrapolated; 0 takes plain steps. The stress never rises.
    as_published : bool
        Follow the paper to the letter: open cells, commute times from K eigenpairs, biharmonic distances as they are,
        unscaled terms, plain steps.
    memory_limit : float
        Most memory that may be used, in gigabytes.
    """

    diffusion_time: float = 0.15
    eigenpairs: int = 100
    prominence: float = 0.5
    merge_distance: float = 0.05
    feature_points: Sequence[int] | None = None
    start: str = "intrinsic"
    landmarks: int = 120
    feature_share: float = 0.03
    iterations: int = 300
    tolerance: float = 1e-4
    extrapolation: int = 6
    as_published: bool = False
    memory_limit: float = 8.0

    def __post_init__(self) -> None:
        """Refuse values outside their range.

        Raises
        ------
        InvalidSettingsError
            With the name of the option, its range and the value given.
        """
        _require(0 < self.diffusion_time <= 50, "diffusion_time", "above 0 and at most 50", self.diffusion_time)
        _require(self.eigenpairs >= 1, "eigenpairs", "at least 1", self.eigenpairs)
        _require(self.prominence >= 0, "prominence", "at least 0", self.prominence)
        _require(0 <= self.merge_distance <= 1, "merge_distance", "from 0 to 1", self.merge_distance)
        _require(self.start in STARTS, "start", "'intrinsic' or 'input'", self.start)
        _require(self.landmarks >= 4, "landmarks", "at least 4", self.landmarks)
        _require(0 <= self.feature_share <= 10, "feature_share", "from 0 to 10", self.feature_share)
        _require(self.iterations >= 0, "iterations", "at least 0", self.iterations)
        _require(self.tolerance >= 0, "tolerance", "at least 0", self.tolerance)
        _require(self.extrapolation >= 0, "extrapolation", "at least 0", self.extrapolation)
        _require(self.memory_limit > 0, "memory_limit", "above 0", self.memory_limit)


def _require(holds: bool, name: str, range_: str, value: object) -> None:
    if not holds:
        raise InvalidSettingsError(f"{name} must be {range_}; got {value!r}.")
