"""What is found on a surface before it is unfolded: its spectrum, feature points and patches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .coarsening import Coarsening, coarsened
from .delaunay import intrinsic_delaunay
from .errors import InvalidSettingsError
from .features import merged, prominent_maxima
from .heat import HeatMethod
from .laplacian import mass, stiffness
from .memory import require_memory
from .monitor import Cancelled, Monitor, Progress
from .patches import voronoi_cells
from .settings import Settings
from .spectrum import Spectrum, auto_diffusion, compute_spectrum
from .surface import FloatArray, IntArray, Triangulation, checked_mesh, surface_area, triangulated

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

PATCHES_AT = 0.43  # of the whole job is done when the patches are known
_WORTH_COARSENING = 1.2  # times as many vertices as are worked on
_SPARE = 4  # times as many candidates as feature points wanted, since some lie too close to others
_STUCK = 2.0  # times as many vertices as asked for are left: the coarse mesh is not one


@dataclass(frozen=True, eq=False)
class FeaturePatches:
    """Feature points and patches of a mesh.

    Attributes
    ----------
    feature_points : (k,) ndarray of int
        Vertices, most prominent first, or as given.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to.
    adf : (n,) ndarray of float
        Auto Diffusion Function of the surface scaled to unit area.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of str
        Sentences for the user.
    """

    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    timings: dict[str, float]
    warnings: list[str]


@dataclass(frozen=True, eq=False)
class Recognition:
    """A mesh scaled to unit area, the mesh that is worked on, and what was found there.

    Attributes
    ----------
    whole_points : (n, 3) ndarray of float
        All vertices, centred and scaled to unit area.
    whole_triangles : (m, 3) ndarray of int
        All triangles.
    centre : (3,) ndarray of float
        Where the centre was, in the unit of the input.
    unit : float
        Root of the area, in the unit of the input.
    coarse : Coarsening or None
        The vertices that are worked on; None for all of them.
    points : (c, 3) ndarray of float
        Vertices that are worked on.
    triangles : (d, 3) ndarray of int
        Their triangles.
    surface : Triangulation
        Their intrinsic Delaunay triangulation.
    stiffness : (c, c) scipy.sparse.csr_matrix
        L.
    mass : (c,) ndarray of float
        Diagonal of M.
    spectrum : Spectrum
        Eigenpairs of L and M.
    adf : (c,) ndarray of float
        Auto Diffusion Function.
    features : (k,) ndarray of int
        Feature points among the vertices that are worked on.
    to_features : (c, k) ndarray of float
        Geodesic distances from them.
    cells : (c,) ndarray of int
        Patch of every vertex that is worked on.
    """

    whole_points: FloatArray
    whole_triangles: IntArray
    centre: FloatArray
    unit: float
    coarse: Coarsening | None
    points: FloatArray
    triangles: IntArray
    surface: Triangulation
    stiffness: csr_matrix
    mass: FloatArray
    spectrum: Spectrum
    adf: FloatArray
    features: IntArray
    to_features: FloatArray
    cells: IntArray

    @property
    def whole_features(self) -> IntArray:
        """Feature points among all vertices, (k,)."""
        return self.features if self.coarse is None else self.coarse.kept[self.features]

    def carried_back(self, monitor: Monitor) -> tuple[IntArray, IntArray, FloatArray]:
        """Carry what was found to all vertices.

        Parameters
        ----------
        monitor : Monitor
            Asked whether to stop.

        Returns
        -------
        features : (k,) ndarray of int
            Feature points.
        cells : (n,) ndarray of int
            Patch of every vertex.
        adf : (n,) ndarray of float
            Auto Diffusion Function.

        Raises
        ------
        CancelledError
            If the monitor says so.
        """
        if self.coarse is None:
            return self.features, self.cells, self.adf
        features = self.whole_features
        cells = voronoi_cells(self.coarse.carried_back(self.to_features), features, self.whole_triangles)
        monitor.check()
        return features, cells, self.coarse.carried_back(self.adf)


def recognised(vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor) -> Recognition:
    """Check a mesh, reduce it to the vertices that are worked on, and find its feature points and patches.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one connected surface.
    settings : Settings
        Options.
    monitor : Monitor
        Told the progress, up to `PATCHES_AT`, and asked whether to stop.

    Returns
    -------
    Recognition
        What was found.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point given by hand is not a vertex, or is given twice.
    TooLargeError
        If the mesh does not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If the monitor says so.
    """
    with monitor.stage("Surface", 0.02):
        whole_points, whole_triangles = checked_mesh(vertices, faces)
        given = _checked_features(settings.feature_points, len(whole_points))
        require_memory(len(whole_points), settings)
        monitor.check()
        centre, unit = whole_points.mean(axis=0), float(np.ptp(whole_points, axis=0).max())
        whole_points = (whole_points - centre) / unit
        size = np.sqrt(surface_area(whole_points, whole_triangles))
        whole_points, unit = whole_points / size, unit * size
    coarse = None
    points, triangles = whole_points, whole_triangles
    if settings.coarse_vertices is not None and len(points) > _WORTH_COARSENING * settings.coarse_vertices:
        with monitor.stage("Coarse mesh", 0.3):
            coarse = coarsened(points, triangles, settings.coarse_vertices, given, monitor)
            points, triangles = points[coarse.kept], coarse.faces
            given = None if given is None else np.searchsorted(coarse.kept, given)
            if len(points) > _STUCK * settings.coarse_vertices:
                monitor.warn(
                    f"The mesh could only be reduced to {len(points):,} vertices, because of its many borders or edges "
                    "of more than two faces; the computation takes longer. Merge vertices by distance for a faster one."
                )
    with monitor.stage("Triangulation", 0.32):
        surface = intrinsic_delaunay(triangulated(points, triangles))
        L, M = stiffness(surface), mass(surface)
    with monitor.stage("Spectrum", 0.4):
        spectrum = compute_spectrum(L, M, settings.eigenpairs, monitor)
        if len(spectrum.eigenvalues) < settings.eigenpairs:
            monitor.warn(f"The mesh is small: all {len(spectrum.eigenvalues)} eigenpairs that it has were used.")
    with monitor.stage("Feature points", 0.42):
        adf = auto_diffusion(spectrum, settings.diffusion_time)
        heat = HeatMethod(surface, refine=settings.whole, monitor=monitor)
        threshold = 0.0 if settings.feature_count else settings.prominence
        features = prominent_maxima(adf, triangles, threshold)[0] if given is None else given
        if given is None and settings.feature_count:
            features = features[: _SPARE * settings.feature_count]
        monitor.check()
        to_features = heat.distances(features)
        if given is None:
            kept = merged(features, to_features[features], settings.merge_distance * float(to_features.max()))
            kept = kept[: settings.feature_count or None]
            if len(kept) < settings.feature_count:
                monitor.warn(f"The surface has {len(kept)} feature points, fewer than the number asked for.")
            features, to_features = features[kept], to_features[:, kept]
    with monitor.stage("Patches", PATCHES_AT):
        cells = voronoi_cells(to_features, features, triangles)
    return Recognition(
        whole_points, whole_triangles, centre, unit, coarse, points, triangles, surface, L, M, spectrum, adf, features,
        to_features, cells,
    )  # fmt: skip


def feature_patches(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> FeaturePatches:
    """Find the feature points and patches of a mesh, and stop there.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one connected surface.
    settings : Settings, optional
        Options.
    progress, cancelled : callable, optional
        As in `canonical_form`.

    Returns
    -------
    FeaturePatches
        The same that `canonical_form` finds.

    Raises
    ------
    CanonicalFormError
        As `canonical_form` does.
    """
    whole = progress and (lambda done, stage: progress(min(done / PATCHES_AT, 1.0), stage))
    monitor = Monitor(whole, cancelled)
    found = recognised(vertices, faces, settings or Settings(), monitor)
    features, cells, adf = found.carried_back(monitor)
    return FeaturePatches(features, cells, adf, monitor.timings, monitor.warnings)


def _checked_features(given: object, vertex_count: int) -> IntArray | None:
    if given is None:
        return None
    features = np.asarray(given)
    if features.ndim != 1 or not features.size or not np.issubdtype(features.dtype, np.integer):
        raise InvalidSettingsError("feature_points must be a list of at least one vertex index.")
    if features.min() < 0 or features.max() >= vertex_count:
        raise InvalidSettingsError(f"feature_points must lie between 0 and {vertex_count - 1}.")
    if len(np.unique(features)) < len(features):
        raise InvalidSettingsError("feature_points names a vertex twice.")
    return features.astype(np.int64)
