"""The options of a computation."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any

from ..run.errors import InvalidSettingsError
from .options import Choice, option, options_of, require_allowed
from .registry import OURS, declared_method

_COARSE = {"draft": 700, "normal": 1600}  # working vertices


@dataclass(frozen=True)
class Settings:
    """Options of the canonical form; the defaults suit posed figures and animals.

    Attributes
    ----------
    method : str
        Name of a method of `addon.core.methods`: 'local_features', the method of this project, the paper to the
        letter ('as_published', 'as_published_closed'), or a rival to compare with. Rivals work on all vertices: from
        all pairs of them at quality 'full', otherwise from landmarks.
    quality : {'draft', 'normal', 'full'}
        Number of working vertices. Draft: 700 vertices; normal: 1,600; the result is interpolated to all vertices, at a
        cost that grows linearly with their number. Full: all vertices, at a cost and memory that grow with the square
        of their number.
    preserve_detail : float
        From 0, plain multidimensional scaling, to 1, the surface kept as rigid as possible.
    diffusion_time : float
        t of the Auto Diffusion Function (equation 7), in multiples of 1/λ_1. Larger: fewer, broader features.
    eigenpairs : int
        Number K of eigenpairs in the Auto Diffusion Function.
    prominence : float
        Minimum prominence of a feature point: the logarithm of the ratio of the Auto Diffusion Function there to that
        at the pass to a higher point. Larger: fewer features.
    feature_count : int
        Number of feature points, the most prominent; 0 to select by `prominence`.
    merge_distance : float
        Feature points closer than this share of the geodesic diameter become one, 0 to 1.
    feature_points : sequence of int, optional
        Vertices to use as feature points instead of those detected, in the order of their patches.
    start : {'intrinsic', 'input'}
        Start of the minimisation: landmark classical scaling, which depends on the surface alone, or the input, whose
        pose the result then keeps in part.
    landmark_count : int
        Number of landmarks of the intrinsic start, and of rivals below quality 'full'.
    smoothing : float
        Diffusion time of the geodesics inside patches, as a share of the area; those between landmarks use a fiftieth
        of it and are averaged with biharmonic ones. Such distances hardly shorten where a joint bends. 0: geodesics
        alone, as accurate as the heat method, and no struts through the interior: for sheets to be unrolled.
    arrangement_share : float
        Weight of the other landmarks on a landmark, relative to the weight of its patch.
    arrangement : {'straight', 'stress'}
        Whether limbs are straightened and pushed apart before the lengths of the surface are restored, or left as the
        stress places them. With `start` 'input' or `preserve_detail` 0, always the latter.
    symmetry : {'hold', 'ignore'}
        Whether the straight form of a mirror-symmetric surface is kept symmetric.
    orientation : {'posed', 'upright', 'two_legs', 'all_fours'}
        Orientation of the form: that of the input, or determined by the surface, equal for all poses: Z up, facing -Y.
    max_iterations : int
        Maximum number of majorisation steps.
    tolerance : float
        Stop when a step reduces the stress by less than this fraction.
    extrapolation : int
        Number of earlier steps from which the next is extrapolated; 0 for plain steps. The stress never increases.
    pieces : {'together', 'apart'}
        Whether loose parts that lie on, in or inside each other are one body, or each has a form of its own.
    memory_limit : float
        Maximum memory in gigabytes; 0 for 60 % of what is free when the run starts.

    Raises
    ------
    InvalidSettingsError
        If a value has the wrong type or lies outside its range; the message names the option and the range.

    Examples
    --------
    >>> settings = Settings(quality="draft", prominence=0.8)
    >>> settings.coarse_vertices
    700
    """

    method: str = option(OURS, "Method", "How the surface is unfolded")
    quality: str = option(
        "normal",
        "Quality",
        "Number of vertices that the form is computed on",
        choices=(
            Choice("draft", "Draft", "Computed on 700 vertices: a quick preview"),
            Choice(
                "normal",
                "Normal",
                "Computed on 1,600 vertices, interpolated to all: a second or two, more on large meshes",
            ),
            Choice("full", "Full", "All vertices, all pairs in a patch: minutes above 20,000 vertices; for reference"),
        ),
    )
    preserve_detail: float = option(
        0.5, "Preserve Detail", "0: plain multidimensional scaling; 1: as rigid as possible", low=0, high=1
    )
    diffusion_time: float = option(
        0.15,
        "Diffusion Time",
        "Time of the Auto Diffusion Function, in multiples of 1/λ₁; larger gives fewer, broader features",
        low=0,
        above=True,
        high=50,
        soft_high=1.0,
        digits=3,
    )
    eigenpairs: int = option(
        80, "Eigenpairs", "Number of Laplacian eigenpairs in the Auto Diffusion Function", low=1, soft_high=400
    )
    prominence: float = option(
        0.5, "Prominence", "How far a feature point must stand out; larger gives fewer patches", low=0, soft_high=3.0
    )
    feature_count: int = option(
        0, "Number", "Number of feature points, the most prominent ones; 0 to go by prominence", low=0, soft_high=30
    )
    merge_distance: float = option(
        0.05,
        "Merge Distance",
        "Feature points closer than this fraction of the geodesic diameter are merged",
        low=0,
        high=1,
    )
    feature_points: Sequence[int] | None = option(
        None, "Feature Points", "Vertex indices to use as feature points, separated by commas; empty to detect them"
    )
    start: str = option(
        "intrinsic",
        "Start",
        "Where the minimisation of the stress starts",
        choices=(
            Choice("intrinsic", "Surface", "From a layout computed from the surface only, independent of the pose"),
            Choice("input", "Pose", "From the input mesh; the result keeps part of its pose"),
        ),
    )
    landmark_count: int = option(
        100,
        "Landmarks",
        "Number of points in the initial layout",
        low=4,
        soft_high=500,
        former="landmarks",
    )
    smoothing: float = option(
        0.1,
        "Smoothing",
        "Diffusion time for averaging geodesics, as a fraction of the area; at 0 they are exact and shorten where "
        "joints bend",
        low=0,
        high=10,
        soft_high=1.0,
        digits=3,
    )
    arrangement_share: float = option(
        10.0,
        "Arrangement Weight",
        "Weight of the landmarks relative to the patches",
        low=0,
        high=100,
        soft_high=20.0,
    )
    arrangement: str = option(
        "straight",
        "Arrangement",
        "Arrangement of the limbs",
        choices=(
            Choice("straight", "Straight", "Limbs straight and as far apart as their lengths allow"),
            Choice("stress", "Stress", "As the stress leaves them: slightly curved, and closer to the pose"),
        ),
    )
    symmetry: str = option(
        "hold",
        "Symmetry",
        "How left and right are treated in a straight arrangement",
        choices=(
            Choice("hold", "Hold", "Make left and right of the form symmetric if the surface is"),
            Choice("ignore", "Ignore", "Left and right come out as the surface has them in this pose"),
        ),
    )
    orientation: str = option(
        "posed",
        "Orientation",
        "Orientation of the form",
        choices=(
            Choice("posed", "As Posed", "As near to the pose as a rotation brings it"),
            Choice("upright", "Upright", "Z up, facing -Y, as the surface decides: alike for all poses of a body"),
            Choice("two_legs", "On Two Legs", "Upright, with the head up"),
            Choice("all_fours", "On All Fours", "Upright, with the head to the front and the belly down"),
        ),
    )
    max_iterations: int = option(
        300, "Iterations", "Maximum number of minimisation steps", low=0, soft_high=1000, former="iterations"
    )
    tolerance: float = option(
        1e-3,
        "Tolerance",
        "Stop when the relative decrease of the stress per step is below this",
        low=0,
        soft_high=0.01,
        digits=8,
    )
    extrapolation: int = option(
        6,
        "Extrapolation",
        "Number of earlier steps from which the next is extrapolated; 0 for plain steps",
        low=0,
        soft_high=12,
    )
    pieces: str = option(
        "together",
        "Loose Parts",
        "How loose parts are treated",
        choices=(
            Choice("together", "Together", "Parts that lie on, in or inside each other are unfolded as one body"),
            Choice("apart", "Apart", "Every part gets feature points and a form of its own and stays in its place"),
        ),
    )
    memory_limit: float = option(
        0.0,
        "Memory Limit",
        "Maximum memory in gigabytes; 0: 60 % of the free memory",
        low=0,
        soft_high=64.0,
    )

    def __post_init__(self) -> None:
        """Reject values of a wrong type or outside their range."""
        require_allowed(self)
        if self.method != OURS:
            declared_method(self.method)

    @property
    def whole(self) -> bool:
        """Whether all vertices and all pairs inside a patch are used."""
        return self.quality == "full"

    @property
    def coarse_vertices(self) -> int | None:
        """Number of working vertices; None for all."""
        return _COARSE.get(self.quality)

    @property
    def straight(self) -> bool:
        """Whether limbs are straightened: not from the input, whose pose is kept in part, and not in a plain form."""
        return self.arrangement == "straight" and self.start == "intrinsic" and self.preserve_detail > 0

    @property
    def together(self) -> bool:
        """Whether loose parts that belong together are one body."""
        return self.pieces == "together"

    @property
    def heat_time(self) -> float | None:
        """Diffusion time of the geodesics inside patches, a squared length on a surface of unit area; None: minimal."""
        return self.smoothing or None

    @property
    def minimisation(self) -> dict[str, Any]:
        """Options of `minimise_stress`."""
        return {name: getattr(self, name) for name in ("max_iterations", "tolerance", "extrapolation")}


_GONE: dict[str, Any] = {"as_published": False, "unbending": 0.0}  # options of version 0.1 without a replacement


def former_options() -> dict[str, Any]:
    """List the options of version 0.1 that were removed or renamed, with a value of the type of each.

    Returns
    -------
    dict
        Values by name.

    Examples
    --------
    >>> sorted(former_options())
    ['as_published', 'iterations', 'landmarks', 'unbending']
    """
    default = Settings()
    renamed = {about.former: getattr(default, name) for name, about in options_of(Settings).items() if about.former}
    return renamed | _GONE


def current_options(given: dict[str, Any]) -> dict[str, Any]:
    """Translate options of version 0.1 that were renamed or removed, with a warning.

    Parameters
    ----------
    given : dict
        Options by name.

    Returns
    -------
    dict
        The same under their current names.

    Raises
    ------
    InvalidSettingsError
        If a former option has a value of the wrong type.

    Examples
    --------
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore")
    ...     current_options({"landmarks": 50, "as_published": True})
    {'landmark_count': 50, 'method': 'as_published'}
    """
    today = {about.former: name for name, about in options_of(Settings).items() if about.former}
    # `dataclasses.replace` passes all current names besides the former one, which takes precedence
    result = {name: value for name, value in given.items() if name not in (*today, *_GONE)}
    for name, value in given.items():
        if name == "unbending":
            _warn_former(name, "limbs are straight without it")
        elif name == "as_published":
            _warn_former(name, 'use method="as_published"')
            if not isinstance(value, bool):
                raise InvalidSettingsError("setting_range", name=name, range="True or False", value=value)
            if value:
                result["method"] = "as_published"
        elif name in today:
            _warn_former(name, f"use {today[name]}")
            result[today[name]] = value
    return result


def _warn_former(name: str, advice: str) -> None:
    sentence = f"The setting {name} is deprecated and will be removed in version 2.0; {advice}."
    warnings.warn(sentence, FutureWarning, stacklevel=4)


def _accepting_former_names(initialise: Callable[..., None]) -> Callable[..., None]:
    """Let scripts written for version 0.1 run for one more version."""

    @wraps(initialise)
    def accepting(self: Settings, *values: Any, **given: Any) -> None:
        initialise(self, *values, **current_options(given))

    return accepting


Settings.__init__ = _accepting_former_names(Settings.__init__)  # type: ignore[method-assign]
