"""What is found on a surface before it is unfolded: its spectrum, feature points and patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..assembly.parts import Parts, connected_parts, features_by_part
from ..detection.auto_diffusion import auto_diffusion
from ..detection.feature_points import merged, prominent_maxima
from ..distances.heat import HeatMethod
from ..mesh.coarsening import Coarsening, coarsened
from ..mesh.geometry import of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import voronoi_cells
from ..run.errors import SolverError
from ..run.memory import require_memory
from ..run.monitor import Cancelled, Monitor, Progress
from ..surface.delaunay import intrinsic_delaunay
from ..surface.laplacian import mass, stiffness
from ..surface.spectrum import Spectrum, compute_spectrum
from ..surface.triangulation import Triangulation, triangulated
from .settings import Settings

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

PATCHES_AT = 0.43  # of the whole job is done when the patches are known
_WORTH_COARSENING = 1.2  # times as many vertices as are worked on
_SPARE = 4  # times as many candidates as feature points wanted, since some lie too close to others
_MORE_SLACK = 0.01  # of every triangle inequality, in mean edges, where the least is too little
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

    def carried_back(self, monitor: Monitor) -> FeaturePatches:
        """Carry what was found to all vertices.

        Parameters
        ----------
        monitor : Monitor
            Asked whether to stop.

        Returns
        -------
        FeaturePatches
            Feature points, patches and Auto Diffusion Function.

        Raises
        ------
        CancelledError
            If the monitor says so.
        """
        features, cells, adf = self.whole_features, self.cells, self.adf
        if self.coarse is not None:
            cells = voronoi_cells(self.coarse.carried_back(self.to_features), features, self.whole_triangles)
            monitor.check()
            adf = self.coarse.carried_back(adf)
        return FeaturePatches(features, cells, adf, monitor.timings, monitor.warnings)


def recognised(
    points: FloatArray, triangles: IntArray, given: IntArray | None, settings: Settings, monitor: Monitor
) -> Recognition:
    """Reduce a surface to the vertices that are worked on, and find its feature points and patches.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertex positions, any unit of length.
    triangles : (m, 3) ndarray of int
        Triangles of one connected surface with some area, each vertex in one at least.
    given : (k,) ndarray of int or None
        Feature points; None to detect them.
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
    TooLargeError
        If the mesh does not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If the monitor says so.
    """
    with monitor.stage("Surface", 0.02):
        monitor.check()
        whole_points, centre, unit = of_unit_area(points, triangles)
        whole_triangles = triangles
    coarse = None
    points = whole_points
    if settings.coarse_vertices is not None and len(points) > _WORTH_COARSENING * settings.coarse_vertices:
        with monitor.stage("Coarse mesh", 0.3):
            coarse = coarsened(points, triangles, settings.coarse_vertices, given, monitor)
            points, triangles = points[coarse.kept], coarse.faces
            given = None if given is None else np.searchsorted(coarse.kept, given)
            if len(points) > _STUCK * settings.coarse_vertices:
                monitor.warn(
                    f"The mesh could only be reduced to {len(points):,} vertices, because of its many borders or edges "
                    "of more than two faces; the computation takes longer and more memory than announced. "
                    "Merge vertices by distance for a faster one."
                )
    with monitor.stage("Triangulation", 0.32):
        surface = intrinsic_delaunay(triangulated(points, triangles), monitor)
        L, M = stiffness(surface), mass(surface)
    with monitor.stage("Spectrum", 0.4):
        try:
            spectrum = compute_spectrum(L, M, settings.eigenpairs, monitor)
        except SolverError:
            monitor.warn(
                "Triangles without any width upset the spectrum; it was computed with every edge lengthened a "
                f"little (at most {_MORE_SLACK:.0%} of the mean edge). Mesh > Clean Up > Degenerate Dissolve "
                "removes such triangles."
            )
            surface = intrinsic_delaunay(triangulated(points, triangles, _MORE_SLACK), monitor)
            L, M = stiffness(surface), mass(surface)
            spectrum = compute_spectrum(L, M, settings.eigenpairs, monitor)
        if len(spectrum.eigenvalues) < settings.eigenpairs:
            monitor.warn("The mesh is small: it has fewer eigenpairs than asked for, and all were used.")
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
    settings = settings or Settings()
    monitor = Monitor(progress, cancelled)
    parts, given = parts_to_work_on(vertices, faces, settings, monitor)
    found = []
    for (part, own), points in zip(parts.each(monitor, PATCHES_AT), given, strict=True):
        each = recognised(part.points, part.faces, None if points is None else points[1], settings, own)
        found.append(each.carried_back(own))
    return together(parts, found, given, settings.feature_points, monitor)


def parts_to_work_on(
    vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor
) -> tuple[Parts, list[tuple[IntArray, IntArray] | None]]:
    """Find the connected surfaces in a mesh and refuse, before anything is computed, what cannot be worked on.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions.
    faces : (m, 3) array_like of int
        Triangles.
    settings : Settings
        Options.
    monitor : Monitor
        Told the progress, warned, and asked whether to stop.

    Returns
    -------
    parts : Parts
        The surfaces.
    given : list of ((t,) ndarray of int, (t,) ndarray of int) or None
        From `features_by_part`.

    Raises
    ------
    InvalidMeshError, InvalidSettingsError, TooLargeError
        As `canonical_form` does.
    CancelledError
        If the monitor says so.
    """
    with monitor.stage("Surface", 0.02):
        parts = connected_parts(vertices, faces, monitor)
        given = features_by_part(parts, settings.feature_points)
        require_memory(max(len(part.vertices) for part in parts.parts), settings)
    monitor.warnings += parts.mended + parts.apart
    return parts, given


def together(
    parts: Parts,
    found: list[FeaturePatches],
    given: list[tuple[IntArray, IntArray] | None],
    chosen: Sequence[int] | None,
    monitor: Monitor,
) -> FeaturePatches:
    """Put what was found on the parts of a mesh together.

    Parameters
    ----------
    parts : Parts
        The mesh.
    found : list of FeaturePatches
        What was found on each part, as its vertices.
    given : list of ((t,) ndarray of int, (t,) ndarray of int) or None
        From `features_by_part`: those that were given come first, in their order.
    chosen : sequence of int, or None
        The vertices that were given, which may be copies of those found.
    monitor : Monitor
        Of the whole.

    Returns
    -------
    FeaturePatches
        The same on all vertices.
    """
    count = len(parts.vertices)
    features = [part.vertices[each.feature_points] for part, each in zip(parts.parts, found, strict=True)]
    first = np.cumsum([0, *[len(each) for each in features]])
    place = [
        count + start + np.arange(len(each)) if points is None else points[0]
        for start, each, points in zip(first[:-1], features, given, strict=True)
    ]
    order = np.argsort(np.concatenate(place), kind="stable")
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    cells = [number[start + each.patches] for start, each in zip(first[:-1], found, strict=True)]
    detected = sum(points is None for points in given)
    if 0 < detected < len(given):
        monitor.warn(f"{detected} loose parts have none of the given feature points; theirs were detected.")
    points = np.concatenate(features)[order]
    if chosen is not None:
        points[: len(chosen)] = chosen
    return FeaturePatches(
        points,
        parts.together(cells, np.full(count, -1)),
        parts.together([each.adf for each in found], np.zeros(count)),
        monitor.timings,
        monitor.warnings,
    )
