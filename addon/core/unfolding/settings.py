"""The options of the method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral, Real

from ..run.errors import InvalidSettingsError

METHODS = (
    "local_features",
    "classical",
    "least_squares",
    "non_metric",
    "fast",
    "euclidean_random",
    "euclidean_normalised",
    "one_form",
    "skeleton",
)
STARTS = ("intrinsic", "input")
QUALITIES = ("draft", "normal", "full")
_KINDS = {int: (Integral, "a whole number"), float: (Real, "a number"), bool: (bool, "True or False")}
_COARSE = {"draft": 700, "normal": 1600}  # vertices of the mesh that is worked on


@dataclass(frozen=True)
class Settings:
    """Options of the canonical form; the defaults suit posed figures and animals.

    Attributes
    ----------
    method : str
        One of `METHODS`: 'local_features', the method of this project, or a rival to compare with. The rivals work on
        all vertices: from all pairs of them at quality 'full', otherwise from landmarks. Only `landmarks`,
        `iterations`, `tolerance`, `extrapolation` and what finds feature points matter to them.
    quality : {'draft', 'normal', 'full'}
        How much of the mesh is worked on. Draft: 700 vertices; normal: 1,600; the result is carried back to all
        vertices, at a cost that grows like their number. Full: all vertices, at a cost and memory that grow like the
        square of their number.
    preserve_detail : float
        From 0, the bare form of multidimensional scaling, to 1, the surface kept as rigid as possible.
    diffusion_time : float
        t of the Auto Diffusion Function (equation 7), in multiples of 1/λ_1. Larger: fewer, broader features.
    eigenpairs : int
        Number K of eigenpairs in the Auto Diffusion Function and, as published, in the commute time.
    prominence : float
        Least prominence of a feature point: the logarithm of how many times higher the Auto Diffusion Function is
        there than at the pass to a higher point. Larger: fewer features.
    feature_count : int
        Number of feature points, the most prominent; 0 to go by `prominence`.
    merge_distance : float
        Feature points closer than this share of the geodesic diameter become one, 0 to 1.
    feature_points : sequence of int, optional
        Vertices to use as feature points instead of those detected, in the order of their patches.
    start : {'intrinsic', 'input'}
        Where the minimisation starts: from landmark classical scaling, which knows the surface alone, or from the
        input, whose pose the result then keeps in part.
    landmarks : int
        Number of landmarks of the intrinsic start.
    smoothing : float
        Diffusion time of the geodesics inside patches, as a share of the area; those between landmarks have a
        fiftieth of it and are averaged with biharmonic ones. Such distances hardly shorten where a joint bends.
        0: geodesics alone, as accurate as the heat method is, and no struts through the flesh: for sheets that are
        to be unrolled.
    arrangement_share : float
        How much the other landmarks pull at a landmark, as a share of the weight with which its patch holds it.
    unbending : float
        How strongly the landmarks push each other apart in the end, against the lengths of the edges. 3 lengthens
        thin limbs by a sixth and takes more of the pose out, which helps to find shapes of one kind; 0: not at all.
    iterations : int
        Most majorisation steps.
    tolerance : float
        Stop when a step lowers the stress by less than this share of it.
    extrapolation : int
        Number of earlier steps from which the next is extrapolated; 0 takes plain steps. The stress never rises.
    as_published : bool
        Follow the paper to the letter: open cells, all vertices, commute times from K eigenpairs, biharmonic distances
        as they are, unscaled terms, plain steps, no detail pass.
    memory_limit : float
        Most memory that may be used, in gigabytes; 0 for 60 % of what is free when the run starts.
    """

    method: str = "local_features"
    quality: str = "normal"
    preserve_detail: float = 0.5
    diffusion_time: float = 0.15
    eigenpairs: int = 80
    prominence: float = 0.5
    feature_count: int = 0
    merge_distance: float = 0.05
    feature_points: Sequence[int] | None = None
    start: str = "intrinsic"
    landmarks: int = 100
    smoothing: float = 0.1
    arrangement_share: float = 10.0
    unbending: float = 0.0
    iterations: int = 300
    tolerance: float = 1e-3
    extrapolation: int = 6
    as_published: bool = False
    memory_limit: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values outside their range.

        Raises
        ------
        InvalidSettingsError
            With the name of the option, its range and the value given.
        """
        for name, field in self.__dataclass_fields__.items():
            if type(field.default) in _KINDS:
                kind, called = _KINDS[type(field.default)]
                _require(isinstance(getattr(self, name), kind), name, called, getattr(self, name))
        _require(self.method in METHODS, "method", f"one of {', '.join(METHODS)}", self.method)
        _require(
            not (self.as_published and self.method != "local_features"),
            "as_published", "off with a rival method, which has nothing to do as published", self.as_published,
        )  # fmt: skip
        _require(self.quality in QUALITIES, "quality", "'draft', 'normal' or 'full'", self.quality)
        _require(0 <= self.preserve_detail <= 1, "preserve_detail", "from 0 to 1", self.preserve_detail)
        _require(0 < self.diffusion_time <= 50, "diffusion_time", "above 0 and at most 50", self.diffusion_time)
        _require(self.eigenpairs >= 1, "eigenpairs", "at least 1", self.eigenpairs)
        _require(self.prominence >= 0, "prominence", "at least 0", self.prominence)
        _require(self.feature_count >= 0, "feature_count", "at least 0", self.feature_count)
        _require(0 <= self.merge_distance <= 1, "merge_distance", "from 0 to 1", self.merge_distance)
        _require(self.start in STARTS, "start", "'intrinsic' or 'input'", self.start)
        _require(self.landmarks >= 4, "landmarks", "at least 4", self.landmarks)
        _require(0 <= self.smoothing <= 10, "smoothing", "from 0 to 10", self.smoothing)
        _require(0 <= self.arrangement_share <= 100, "arrangement_share", "from 0 to 100", self.arrangement_share)
        _require(0 <= self.unbending <= 100, "unbending", "from 0 to 100", self.unbending)
        _require(self.iterations >= 0, "iterations", "at least 0", self.iterations)
        _require(self.tolerance >= 0, "tolerance", "at least 0", self.tolerance)
        _require(self.extrapolation >= 0, "extrapolation", "at least 0", self.extrapolation)
        _require(self.memory_limit >= 0, "memory_limit", "at least 0", self.memory_limit)

    @property
    def whole(self) -> bool:
        """Whether all vertices and all pairs inside a patch are used."""
        return self.as_published or self.quality == "full"

    @property
    def coarse_vertices(self) -> int | None:
        """Number of vertices to work on; None for all."""
        return None if self.whole else _COARSE[self.quality]

    @property
    def heat_time(self) -> float | None:
        """Diffusion time of the geodesics inside patches, a squared length on a surface of unit area; None: least."""
        return None if self.as_published or self.smoothing == 0 else self.smoothing


def _require(holds: bool, name: str, range_: str, value: object) -> None:
    if not holds:
        raise InvalidSettingsError(f"{name} must be {range_}; got {value!r}.")
