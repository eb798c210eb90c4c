"""The options of a computation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from typing import Any

from ..numerics.arrays import IntArray
from ..run.errors import InvalidSettingsError
from ..symmetry.limb_names import checked_names
from .options import Choice, option, require_allowed, vertex_list
from .registry import OURS, declared_method

_COARSE = {"draft": 700, "normal": 1600}  # working vertices


@dataclass(frozen=True)
class Settings:
    """Options of the canonical form; the defaults suit posed figures and animals.

    Attributes
    ----------
    method : str
        Name of a method of `addon.core.methods`: 'straight', the default; 'local_features', the paper's stress with
        repairs; that stress as published ('as_published', 'as_published_closed'); or a rival to compare with. Rivals
        work on all vertices: from all pairs of them at quality 'full', otherwise from landmarks.
    quality : {'draft', 'normal', 'full'}
        Number of working vertices. Draft: 700 vertices; normal: 1,600; the result is interpolated to all vertices, at a
        cost that grows linearly with their number. Full: all vertices, at a cost and memory that grow with the square
        of their number.
    preserve_detail : float
        From 0, the arrangement alone, without the detail of the input, to 1, the surface kept as rigid as possible.
    diffusion_time : float
        t of the Auto Diffusion Function (equation 7), in multiples of 1/λ_1. Larger: fewer, broader features.
    eigenpairs : int
        Number K of eigenpairs in the Auto Diffusion Function, and in the distances of the paper as published.
    prominence : float
        Minimum prominence of a feature point: the logarithm of the ratio of the Auto Diffusion Function there to that
        at the pass to a higher point. Larger: fewer features.
    feature_count : int
        Number of feature points, the most prominent; 0 to select by `prominence`.
    feature_points : sequence of int, optional
        Vertices to use as feature points instead of those detected, in the order of their patches.
    feature_names : sequence of str, optional
        What they are, one for each: 'head', 'left_hand', 'right_hand', 'left_foot', 'right_foot', 'tail', or '' for
        none of these; of an animal the front feet are its hands. Form, match, T-pose and rig take left and right, front
        and back from them.
    landmark_count : int
        Number of landmarks that lay the surface out, and of rivals below quality 'full'.
    start : {'classical', 'input'}
        Where the paper's stress starts from, as published: the classical embedding of the surface, or the mesh.
    pair_weight : {'squared', 'plain'}
        Weight of a pair inside a patch over its squared distance, as published: c² or c (equation 8).
    biharmonic_scale : {'own', 'geodesic'}
        Biharmonic distances between feature points, as published: as they are, or as long as geodesics.
    symmetry : {'hold', 'ignore'}
        Whether the straight form of a mirror-symmetric surface is kept symmetric.
    orientation : {'posed', 'upright', 'two_legs', 'all_fours'}
        Orientation of the form: that of the input, or determined by the surface, equal for all poses: Z up, facing -Y.
    max_iterations : int
        Maximum number of majorisation steps.
    contacts : {'open', 'keep'}
        Whether skin that has grown together, such as that of a hand on a hip in a scan, is parted for the result where
        a human body looks like it, or another body beside a form of its own as the reference.
    part_here : sequence of int, optional
        Vertices between which the mesh is parted before anything is computed: triangles with three of them are taken
        out, and edges with two are cut. Both lips are closed.
    keep_joined : sequence of int, optional
        Vertices at which nothing is parted that was not marked.
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
            Choice("full", "Full", "All vertices, no coarse mesh: minutes above 20,000 vertices; for reference"),
        ),
    )
    preserve_detail: float = option(
        0.5, "Preserve Detail", "0: only the arrangement of the limbs; 1: as rigid as possible", low=0, high=1
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
    feature_points: Sequence[int] | None = option(
        None, "Feature Points", "Vertex indices to use as feature points, separated by commas; empty to detect them"
    )
    feature_names: Sequence[str] | None = option(
        None,
        "Names of the Points",
        "What the feature points are, separated by commas: head, left_hand, right_hand, left_foot, right_foot, tail",
    )
    landmark_count: int = option(
        100,
        "Landmarks",
        "Number of points that lay the surface out",
        low=4,
        soft_high=500,
    )
    start: str = option(
        "classical",
        "Start",
        "Where the paper's stress starts from, as published",
        choices=(
            Choice("classical", "Classical Scaling", "The classical embedding of the surface"),
            Choice("input", "Mesh", "The mesh in its pose, of which much stays"),
        ),
    )
    pair_weight: str = option(
        "squared",
        "Pair Weight",
        "Weight of a pair inside a patch over its squared distance, as published",
        choices=(
            Choice("squared", "c²", "The squared commute time"),
            Choice("plain", "c", "The commute time, its root"),
        ),
    )
    biharmonic_scale: str = option(
        "own",
        "Biharmonic Scale",
        "Biharmonic distances between feature points, as published",
        choices=(
            Choice("own", "Own", "As they are: shorter than geodesics"),
            Choice("geodesic", "Geodesic", "As long as geodesics in the mean"),
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
    max_iterations: int = option(300, "Iterations", "Maximum number of minimisation steps", low=0, soft_high=1000)
    contacts: str = option(
        "open",
        "Grown Together",
        "What is done where skin has grown together, such as that of a hand on a hip in a scan",
        choices=(
            Choice(
                "open",
                "Open",
                "Part it for the result, if a human body looks like it, or an animal beside its reference; takes some "
                "seconds then",
            ),
            Choice("keep", "Keep", "Leave it, unless it is marked: the result keeps the pose there"),
        ),
    )
    part_here: Sequence[int] | IntArray | None = None
    keep_joined: Sequence[int] | IntArray | None = None
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
        for name in ("part_here", "keep_joined"):
            object.__setattr__(self, name, vertex_list(name, getattr(self, name)))
        count = 0 if self.feature_points is None else len(self.feature_points)
        object.__setattr__(self, "feature_names", checked_names(self.feature_names, count))
        if self.method != OURS:
            declared_method(self.method)

    def detecting(self) -> Settings:
        """Return the same options without feature points chosen by hand."""
        return replace(self, feature_points=None, feature_names=None)

    @property
    def whole(self) -> bool:
        """Whether all vertices and all pairs inside a patch are used."""
        return self.quality == "full"

    @property
    def coarse_vertices(self) -> int | None:
        """Number of working vertices; None for all."""
        return _COARSE.get(self.quality)

    @property
    def parts(self) -> bool:
        """Whether the mesh may be parted before anything is computed."""
        return self.contacts == "open" or self.part_here is not None

    @property
    def together(self) -> bool:
        """Whether loose parts that belong together are one body."""
        return self.pieces == "together"


AnySettings = Settings | Mapping[str, Any] | None  # as doors take them


def settings_from(settings: AnySettings, options: Mapping[str, Any]) -> Settings:
    """Gather settings: given as such or by name, with options over them.

    Parameters
    ----------
    settings : Settings, mapping or None
        Settings, or options by name.
    options : mapping
        Options by name.

    Returns
    -------
    Settings
        All of them.

    Raises
    ------
    InvalidSettingsError
        If there is no such option, or a value is not allowed.

    Examples
    --------
    >>> settings_from({"quality": "draft"}, {"preserve_detail": 0.25}).preserve_detail
    0.25
    """
    if not isinstance(settings, Settings):
        if settings is not None and not isinstance(settings, Mapping):
            raise InvalidSettingsError("options_type", type=type(settings).__name__)
        options = {**settings, **options} if settings is not None else options
        settings = Settings()
    names = [each.name for each in fields(Settings)]
    for name in options:
        if name not in names:
            raise InvalidSettingsError(
                "unknown_option", name=name, names=", ".join(get_close_matches(name, names) or names)
            )
    return replace(settings, **options) if options else settings
