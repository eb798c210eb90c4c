"""Collects the results of an evaluation by method: per class, pose, retrieval and Hausdorff distances."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..core.measures.alignment import rigid_fit
from ..core.mesh.geometry import surface_area
from ..core.numerics.arrays import FloatArray
from .dataset import Shape
from .methods import INPUT, KNOWN, Method
from .retrieval import Retrieval, retrieval
from .store import Store

_POSES = 30  # largest number of shapes of a class that are compared with each other, evenly chosen


@dataclass(frozen=True)
class PoseRatio:
    """Distance between the forms of a class, relative to that of its poses; NaN without a shared vertex order.

    Attributes
    ----------
    apart : float
        Mean root mean square distance of two forms, in units of sqrt(area).
    apart_mirrored : float
        The same with mirror images allowed.
    poses_apart : float
        The same for the meshes in their poses.
    """

    apart: float = float("nan")
    apart_mirrored: float = float("nan")
    poses_apart: float = float("nan")

    @property
    def ratio(self) -> float:
        """The ratio, with proper rotations only."""
        return self.apart / self.poses_apart

    @property
    def ratio_mirrored(self) -> float:
        """The ratio, with mirror images allowed."""
        return self.apart_mirrored / self.poses_apart


@dataclass(frozen=True, eq=False)
class MethodTable:
    """Results of one method for the tables.

    Attributes
    ----------
    method : Method
        The method.
    rows : dict of Shape to dict
        Figures of each successful shape.
    costs : dict of Shape to dict
        Seconds and memory of each successful shape.
    failures : dict of Shape to str
        Reasons for failed shapes.
    poses : dict of str to PoseRatio
        By class.
    found, found_by_pairs : Retrieval
        Retrieval over all successful shapes, by spherical harmonics and by pairs of points.
    distances, pair_distances : (n, n) ndarray of float
        Distances between the descriptors of the successful shapes, in their order.
    """

    method: Method
    rows: dict[Shape, dict[str, Any]]
    costs: dict[Shape, dict[str, Any]]
    failures: dict[Shape, str]
    poses: dict[str, PoseRatio]
    found: Retrieval
    found_by_pairs: Retrieval
    distances: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    pair_distances: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    def values(self, name: str, label: str | None = None) -> FloatArray:
        """Return one figure of all shapes.

        Parameters
        ----------
        name : str
            The figure.
        label : str, optional
            A class; all classes if omitted.

        Returns
        -------
        (s,) ndarray of float
            The existing values.
        """
        kept = [row[name] for shape, row in self.rows.items() if label in (None, shape.label)]
        return np.array([value for value in kept if value is not None], dtype=np.float64)

    def pose_ratio(self, mirrored: bool = False) -> float:
        """Return the ratio of forms to poses, summed over the classes that share a vertex order.

        Parameters
        ----------
        mirrored : bool
            Whether mirror images are allowed.

        Returns
        -------
        float
            The ratio of the sums; NaN if there is no such class.
        """
        usable = [each for each in self.poses.values() if np.isfinite(each.apart) and each.poses_apart > 0]
        if not usable:
            return float("nan")
        return sum(e.apart_mirrored if mirrored else e.apart for e in usable) / sum(e.poses_apart for e in usable)


def method_table(store: Store, shapes: Sequence[Shape], method: Method, lost: dict[Shape, str]) -> MethodTable:
    """Collect the results of a method.

    Parameters
    ----------
    store : Store
        The results.
    shapes : sequence of Shape
        The dataset.
    method : Method
        The method.
    lost : dict of Shape to str
        Reasons for shapes whose result was lost with a worker, or that could not be read.

    Returns
    -------
    MethodTable
        The table.
    """
    rows: dict[Shape, dict[str, Any]] = {}
    costs: dict[Shape, dict[str, Any]] = {}
    failures: dict[Shape, str] = {}
    for shape in shapes:
        result = store.result(shape, method)
        if result is None or "error" in result["row"]:
            failures[shape] = lost.get(shape, "No result.") if result is None else str(result["row"]["error"])
        else:
            rows[shape], costs[shape] = result["row"], result["cost"]
    labels = sorted({shape.label for shape in rows})
    poses = {label: _pose_ratio(store, [s for s in rows if s.label == label], method) for label in labels}
    distances, by_pairs = (
        descriptor_distances(np.array([store.array(shape, method, name) for shape in rows]))
        for name in ("descriptor", "pairs")
    )
    found, found_by_pairs = (retrieval(each, [shape.label for shape in rows]) for each in (distances, by_pairs))
    return MethodTable(method, rows, costs, failures, poses, found, found_by_pairs, distances, by_pairs)


def descriptor_distances(descriptors: FloatArray) -> FloatArray:
    """Return the Euclidean distances between descriptors.

    Parameters
    ----------
    descriptors : (n, d) ndarray of float
        The descriptors.

    Returns
    -------
    (n, n) ndarray of float
        Distances.
    """
    from scipy.spatial.distance import pdist, squareform

    if len(descriptors) < 2:
        return np.zeros((len(descriptors),) * 2)
    return np.asarray(squareform(pdist(descriptors)))


def evenly(shapes: Sequence[Shape], count: int) -> list[Shape]:
    """Choose shapes at even intervals, including the first.

    Parameters
    ----------
    shapes : sequence of Shape
        All shapes.
    count : int
        Largest number of shapes.

    Returns
    -------
    list of Shape
        The chosen shapes, in their order.
    """
    places = np.unique(np.linspace(0, len(shapes) - 1, min(count, len(shapes))).round().astype(int))
    return [shapes[place] for place in places]


def _pose_ratio(store: Store, shapes: list[Shape], method: Method) -> PoseRatio:
    some = evenly(shapes, _POSES)
    kept = [store.array(shape, KNOWN[INPUT], "faces") for shape in some]
    faces = [each for each in kept if each is not None]
    if len(some) < 2 or len(faces) < len(some) or not all(np.array_equal(each, faces[0]) for each in faces):
        return PoseRatio()
    forms, poses = ([scaled_form(store, shape, which) for shape in some] for which in (method, KNOWN[INPUT]))
    return PoseRatio(mean_apart(forms), mean_apart(forms, mirror=True), mean_apart(poses))


def scaled_form(store: Store, shape: Shape, method: Method) -> FloatArray:
    """Read a form at the scale that its method has given it.

    Parameters
    ----------
    store : Store
        Contains the form, and the mesh in its pose.
    shape : Shape
        The shape.
    method : Method
        The method.

    Returns
    -------
    (n, 3) ndarray of float
        The form, in units of sqrt(area) of the pose: a form of its own area would have a torn one shrunk.
    """
    form, pose = (np.asarray(store.array(shape, each, "form"), dtype=np.float64) for each in (method, KNOWN[INPUT]))
    faces = np.asarray(store.array(shape, KNOWN[INPUT], "faces"))
    return np.asarray(form / np.sqrt(surface_area(pose, faces)))


def mean_apart(forms: Sequence[FloatArray], mirror: bool = False) -> float:
    """Return the mean distance of forms with a shared vertex order, over all pairs.

    Parameters
    ----------
    forms : sequence of (n, 3) ndarray of float
        At least two forms.
    mirror : bool
        Whether a mirror image may be used in the rigid fit.

    Returns
    -------
    float
        Mean root mean square distance of matching vertices after a rigid fit, in the unit of the forms.
    """
    return float(np.mean([_apart(one, two, mirror) for one, two in itertools.combinations(forms, 2)]))


def _apart(one: FloatArray, two: FloatArray, mirror: bool) -> float:
    rotation, shift = rigid_fit(one, two, mirror=mirror)
    return float(np.sqrt(((one @ rotation + shift - two) ** 2).sum(axis=1).mean()))
