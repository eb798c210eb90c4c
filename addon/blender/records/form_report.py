"""The report of a run: counts, stress, measures, timings and warnings."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .stored_values import listed, maybe, named, real, whole, words

if TYPE_CHECKING:
    from ...core import Settings
    from ...core.numerics.arrays import FloatArray, IntArray
    from ...core.results import AnyResult


class StressReport(NamedTuple):
    """The stress of the embedding over the minimisation.

    Attributes
    ----------
    first, last : float
        Stress (equation 10) before the first step and after the last.
    steps : int
        Number of steps.
    """

    first: float
    last: float
    steps: int


class LikeReport(NamedTuple):
    """The pose that a mesh was put into.

    Attributes
    ----------
    pose : {'OBJECT', 'T', 'A'}
        Whether the pose is that of an object, or the T-pose or A-pose of a mannequin.
    name : str
        Name of the object.
    key : str
        Name of the shape key.
    side : int
        Index of the way to match that was used.
    sides : list of float
        Scores of the ways to match, the most likely first.
    confidence : float
        Mean confidence of the match.
    source : {'match', 'bones'}
        Whether a match with the other body told the pose, or the bones of the mesh's own rig.
    bones : dict of str to float
        How far the skin of each fitted bone follows it, 0 to 1; empty where no skeleton was fitted.
    """

    pose: str
    name: str
    key: str
    side: int
    sides: list[float]
    confidence: float
    source: str = "match"
    bones: dict[str, float] = {}


@dataclass
class FormReport:
    """Report of a run on one mesh.

    Attributes
    ----------
    vertices, faces : int
        Size of the mesh, with faces counted as triangles.
    feature_points : list of int
        Vertex indices, in the order of the patches; -1 for those on another object of the body.
    patch_sizes : list of int
        Vertices of this mesh in each patch.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of str
        Sentences for the user.
    stress : StressReport or None
        Stress of the embedding; None without a form, and for one that is not the minimum of a stress.
    method : str or None
        Method that computed the form; None if the run stopped at the patches or feature points, or made a pose.
    pieces : str
        Whether loose parts were treated as one body, 'together', or had separate forms, 'apart'.
    pair_count : int
        Number of pair distances that the stress uses; 0 without a stress.
    pair_reduction : float
        Share of all pairs that this saves.
    measures : dict of str to float or None
        Quality measures of the form; None where one is undefined, such as the compactness of an open mesh.
    frame : int or None
        The frame whose pose was removed; None for the base mesh.
    objects : list of str
        Names of the objects of a body of several; stress, pairs and measures then apply to all of them.
    like : LikeReport or None
        The pose that the mesh was put into, if the result is a pose and not a form.
    feature_names : list of str
        What the feature points are, "" for no limb with a name; empty in records of earlier versions.
    notes : list of str
        Those of the warnings that make no result doubtful: what was repaired, and what rides on the body.
    mends : dict of str to str
        What mends a warning, as in `advice.MENDS`, where a button of the panel does.
    """

    vertices: int
    faces: int
    feature_points: list[int]
    patch_sizes: list[int]
    timings: dict[str, float]
    warnings: list[str]
    stress: StressReport | None = None
    method: str | None = None
    pieces: str = "together"
    pair_count: int = 0
    pair_reduction: float = 0.0
    measures: dict[str, float | None] = field(default_factory=dict)
    frame: int | None = None
    objects: list[str] = field(default_factory=list)
    like: LikeReport | None = None
    feature_names: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    mends: dict[str, str] = field(default_factory=dict)

    @property
    def has_form(self) -> bool:
        """Whether the run computed a canonical form, and not a pose or only patches or feature points."""
        return self.method is not None

    @property
    def doubts(self) -> list[str]:
        """The warnings without the notes."""
        return [each for each in self.warnings if each not in self.notes]

    @property
    def seconds(self) -> float:
        """Total computation time of all stages."""
        return sum(self.timings.values())

    @property
    def edge_distortion(self) -> float | None:
        """Median edge distortion of the form; None without a form."""
        return self.measures.get("edge_distortion_median")

    @property
    def compactness_error(self) -> float | None:
        """Change of the compactness; None for an open mesh or without a form."""
        return self.measures.get("compactness_error")

    @classmethod
    def of(
        cls, found: AnyResult, vertices: FloatArray, faces: IntArray, settings: Settings, *, hausdorff: bool = False
    ) -> FormReport:
        """Report a result on arrays.

        Parameters
        ----------
        found : CanonicalForm, PosedLike or FeaturePatches
            The result.
        vertices : (n, 3) ndarray of float
            Positions that it was computed from.
        faces : (m, 3) ndarray of int
            Triangles.
        settings : Settings
            Options that it was computed with.
        hausdorff : bool
            Whether to measure the Hausdorff distance too, whose time is one of the timings.

        Returns
        -------
        FormReport
            The report, with the warnings as the core words them.
        """
        from ...core import CanonicalForm, FeaturePatches
        from ...core.measures.form_measures import summary
        from ...core.measures.limb_bends import bend_summary

        report = cls(
            vertices=len(vertices),
            faces=len(faces),
            feature_points=found.feature_points.tolist(),
            patch_sizes=patch_sizes(found.patches, len(found.feature_points)),
            timings=found.timings,
            warnings=[str(each) for each in found.warnings],
            feature_names=list(found.feature_names),
        )
        if isinstance(found, FeaturePatches):
            return report
        began = perf_counter()
        measures = summary(vertices, found.vertices, found.faces, hausdorff)
        if hausdorff:  # takes longer than the form
            report.timings = {**found.timings, "Hausdorff distance": perf_counter() - began}
        if isinstance(found, CanonicalForm):
            measures |= bend_summary(found.bends)
        report.measures = {name: None if np.isnan(value) else value for name, value in measures.items()}
        report.pieces = settings.pieces
        if isinstance(found, CanonicalForm):
            report.method = settings.method
            if len(found.stress):
                report.stress = StressReport(float(found.stress[0]), float(found.stress[-1]), len(found.stress) - 1)
                report.pair_count, report.pair_reduction = found.pair_count, found.pair_reduction
        return report

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> FormReport:
        """Build a report from its JSON object.

        Parameters
        ----------
        data : dict
            As `as_json` returns it.

        Returns
        -------
        FormReport
            The report.

        Raises
        ------
        KeyError, TypeError, ValueError
            If the data is not that of a report.
        """
        points = listed(whole, data["feature_points"])
        report = cls(
            vertices=whole(data["vertices"]),
            faces=whole(data["faces"]),
            feature_points=points,
            patch_sizes=listed(whole, data["patch_sizes"]),
            timings=named(real, data["timings"]),
            warnings=listed(words, data["warnings"]),
        )
        if "method" in data:
            report.method = words(data["method"])
            report.pieces = words(data.get("pieces", "apart"))
        if "stress" in data:
            stress = data["stress"]
            report.stress = StressReport(real(stress["first"]), real(stress["last"]), whole(stress["steps"]))
            report.pair_count = whole(data["pair_count"])
            report.pair_reduction = real(data["pair_reduction"])
        if "like" in data:
            like = data["like"]
            report.like = LikeReport(
                pose=words(like["pose"]),
                name=words(like["name"]),
                key=words(like["key"]),
                side=whole(like["side"]),
                sides=listed(real, like["sides"]),
                confidence=real(like["confidence"]),
                source=words(like.get("source", "match")),
                bones=named(real, like.get("bones", {})),
            )
            report.pieces = words(data["pieces"])
        if "measures" in data:
            report.measures = named(lambda value: maybe(real, value), data["measures"])
            report.frame = maybe(whole, data.get("frame"))
        report.objects = listed(words, data.get("objects", []))
        report.feature_names = listed(words, data.get("feature_names", []))
        report.notes = listed(words, data.get("notes", []))
        report.mends = named(words, data.get("mends", {}))
        if report.feature_names and len(report.feature_names) != len(points):
            raise ValueError("There is not one name for every feature point.")
        return report

    def as_json(self) -> dict[str, Any]:
        """Convert the report to a JSON object, for the record and the result lines of the command line.

        Returns
        -------
        dict
            Counts, stress, measures, timings and warnings; values of the form only if there is one.
        """
        data: dict[str, Any] = {
            "vertices": self.vertices,
            "faces": self.faces,
            "feature_points": self.feature_points,
            "patch_sizes": self.patch_sizes,
        }
        if self.method is not None:
            data |= {"method": self.method, "measures": self.measures, "pieces": self.pieces}
        if self.stress is not None:
            data |= {
                "stress": self.stress._asdict(),
                "pair_count": self.pair_count,
                "pair_reduction": self.pair_reduction,
            }
        if self.like is not None:
            data |= {"like": self.like._asdict(), "measures": self.measures, "pieces": self.pieces}
        if self.frame is not None:
            data["frame"] = self.frame
        if self.objects:
            data["objects"] = self.objects
        if any(self.feature_names):
            data["feature_names"] = self.feature_names
        if self.notes:
            data["notes"] = self.notes
        if self.mends:
            data["mends"] = self.mends
        return data | {"timings": self.timings, "warnings": self.warnings}


def patch_sizes(patches: IntArray, count: int) -> list[int]:
    """Count the vertices in each patch.

    Parameters
    ----------
    patches : (n,) ndarray of int
        Patch of each vertex; -1 for none.
    count : int
        Number of patches.

    Returns
    -------
    list of int
        The counts.

    Examples
    --------
    >>> patch_sizes(np.array([0, 1, 1, -1]), 3)
    [1, 2, 0]
    """
    sizes: list[int] = np.bincount(patches[patches >= 0], minlength=count).tolist()
    return sizes
