"""Shared by the rivals: all vertices of the surface, and geodesics between them or from landmarks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..deformation.elastic_body import ElasticBody
from ..distances.farthest_points import farthest_points
from ..distances.heat import FEWEST, HeatMethod
from ..distances.patch_geodesics import all_geodesics
from ..embedding.classical_scaling import landmark_scaling, leading_scaling, placed_around
from ..measures.alignment import outside_out
from ..numerics.arrays import FloatArray, IntArray
from ..run.memory import require_pair_memory
from ..run.monitor import Monitor
from ..surface.delaunay import intrinsic_delaunay, refined
from ..surface.laplacian import stiffness_and_mass
from ..surface.triangulation import Triangulation, triangulated
from .method_result import MethodResult
from .settings import Settings
from .surface_features import SurfaceFeatures


@dataclass(frozen=True, eq=False)
class Samples:
    """Geodesic distances of all vertices from some of them.

    Attributes
    ----------
    vertices : (s,) ndarray of int
        The samples; all vertices at quality 'full'.
    distances : (n, s) ndarray of float
        Distance of every vertex from each of them, on a surface of unit area.
    """

    vertices: IntArray
    distances: FloatArray

    @property
    def complete(self) -> bool:
        """Whether every vertex is a sample."""
        return len(self.vertices) == len(self.distances)

    @cached_property
    def between(self) -> FloatArray:
        """Distances among the samples, (s, s), symmetric."""
        if self.complete:
            return self.distances
        square = self.distances[self.vertices]
        return (square + square.T) / 2

    def classical_embedding(self) -> FloatArray:
        """Embed all vertices by classical scaling: from all pairs if they are known, otherwise by the landmarks.

        Gives (n, 3).
        """
        if self.complete:
            return leading_scaling(self.distances)
        embedding = landmark_scaling(self.distances, self.vertices)
        return embedding - embedding.mean(axis=0)

    def spread(self, placed: FloatArray, start: FloatArray, distances: FloatArray | None = None) -> FloatArray:
        """Place all other vertices by their distances from the samples.

        `placed` (s, 3); `start` (n, 3); `distances` (n, s); gives (n, 3).
        """
        if self.complete:
            return placed
        return placed_around(self.distances if distances is None else distances, self.vertices, placed, start)


class WholeSurface:
    """All vertices of a mesh, as the rivals need them.

    `found`: the mesh and its feature points; `settings`: quality and number of landmarks.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        Vertices, of unit area.
    faces : (m, 3) ndarray of int
        Triangles.
    features : (k,) ndarray of int
        Feature points.
    summit : int
        The most prominent of them.
    """

    def __init__(self, found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> None:
        self.points, self.faces, self.features = found.whole_points, found.joined_faces, found.whole_features
        self.summit = found.summit
        self._settings, self._monitor = settings, monitor

    @cached_property
    def surface(self) -> Triangulation:
        """The intrinsic Delaunay triangulation of all vertices."""
        return intrinsic_delaunay(triangulated(self.points, self.faces), self._monitor)

    @cached_property
    def body(self) -> ElasticBody:
        """The mesh as an elastic body, without struts."""
        return ElasticBody(*stiffness_and_mass(self.surface), self.points, self.faces)

    @cached_property
    def heat(self) -> HeatMethod:
        """Geodesics from any vertex."""
        fine = refined(self.surface, FEWEST, self._monitor) if self._settings.whole else self.surface
        return HeatMethod(fine, count=len(self.points), monitor=self._monitor)

    def samples(self) -> Samples:
        """Measure geodesics: between all vertices at quality 'full', otherwise from landmarks spread over the surface.

        Returns
        -------
        Samples
            The samples and distances; the landmarks start with the feature points.

        Raises
        ------
        TooLargeError
            If all pairs do not fit into the memory limit.
        CancelledError
            If the run is cancelled.
        """
        count = len(self.points)
        if self._settings.whole:
            require_pair_memory(count, [count], limit=self._settings.memory_limit, whole=True)
            return Samples(np.arange(count), all_geodesics(self.surface, monitor=self._monitor))
        wanted = self._settings.landmark_count
        landmarks, distances = farthest_points(self.heat, self.features, wanted, monitor=self._monitor)
        distances = np.maximum(distances, 0.0)
        if len(landmarks) == count:  # a small mesh: all pairs, in the order of the vertices
            distances = distances[:, np.argsort(landmarks)]
            return Samples(np.arange(count), (distances + distances.T) / 2)
        return Samples(landmarks, distances)

    def outside_out(self, form: FloatArray) -> FloatArray:
        """Choose between an embedding and its mirror image, which distances cannot distinguish.

        `form` (n, 3); gives (n, 3).
        """
        return outside_out(self.body, form)

    def embedding(self, form: FloatArray, history: ArrayLike, pair_count: int) -> MethodResult:
        """Make the result of an embedding that may be a mirror image.

        `form` (n, 3); `history` (s + 1,); `pair_count`: number of distances used.
        """
        return MethodResult(self.outside_out(form), np.asarray(history, dtype=np.float64), pair_count)
