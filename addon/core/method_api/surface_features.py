"""The input of every method: the working surface, its spectrum, feature points and patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..detection.auto_diffusion import auto_diffusion
from ..detection.feature_points import merged, prominent_maxima
from ..distances.heat import FEWEST, HeatMethod
from ..mesh.geometry import of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import voronoi_cells
from ..run.errors import SolverError
from ..run.monitor import Monitor
from ..surface.delaunay import refined
from ..surface.laplacian import stiffness_and_mass
from ..surface.spectrum import Spectrum, compute_spectrum
from ..surface.working_surface import Reduced, WorkingSurface, working_surface
from ..symmetry.chirality import chirality
from ..symmetry.involutions import MOST_FEATURES
from ..symmetry.limb_names import with_names
from ..symmetry.limbs import Limbs, lasting_order, limbs_of
from ..symmetry.missing_limbs import warn_of_missing_limbs
from .settings import Settings

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_MERGED = 0.05  # share of the geodesic diameter within which two feature points are one
_SPARE = 4  # candidates per feature point requested, since some lie too close to others
_MORE_SLACK = (0.01, 0.1)  # slack of every triangle inequality, in mean edges, tried in turn where the spectrum fails


class WholeFeatures(NamedTuple):
    """The features of a surface, on all its vertices.

    Attributes
    ----------
    points : (k,) ndarray of int
        Feature points.
    cells : (n,) ndarray of int
        Patch of every vertex.
    adf : (n,) ndarray of float
        Auto Diffusion Function of every vertex.
    limbs : Limbs
        Head, tail and sides among the feature points.
    """

    points: IntArray
    cells: IntArray
    adf: FloatArray
    limbs: Limbs


@dataclass(frozen=True, eq=False)
class SurfaceFeatures:
    """A connected surface scaled to unit area, and its features.

    Attributes
    ----------
    whole_points : (n, 3) ndarray of float
        All vertices, centred and scaled to unit area.
    whole_faces : (m, 3) ndarray of int
        All triangles.
    centre : (3,) ndarray of float
        Centre of the input, in its unit.
    unit : float
        Square root of the area, in the unit of the input.
    surface : WorkingSurface
        The working surface, of c vertices.
    stiffness : (c, c) scipy.sparse.csr_matrix
        L.
    mass : (c,) ndarray of float
        Diagonal of M.
    spectrum : Spectrum
        Eigenpairs of L and M.
    adf : (c,) ndarray of float
        Auto Diffusion Function.
    cells : (c,) ndarray of int
        Patch of every working vertex.
    limbs : Limbs
        The feature points among the working vertices, distances from them, head, tail and sides.
    """

    whole_points: FloatArray
    whole_faces: IntArray
    centre: FloatArray
    unit: float
    surface: WorkingSurface
    stiffness: csr_matrix
    mass: FloatArray
    spectrum: Spectrum
    adf: FloatArray
    cells: IntArray
    limbs: Limbs

    @property
    def features(self) -> IntArray:
        """Feature points, as indices of working vertices, (k,)."""
        return self.limbs.features

    @property
    def joined_faces(self) -> IntArray:
        """All triangles and the bridges between the parts of a body: one connected surface, (m + b, 3)."""
        return np.concatenate([self.whole_faces, self.surface.kept[self.surface.bridges]])

    @property
    def summit(self) -> int:
        """The feature point where the Auto Diffusion Function is highest, among all vertices."""
        return int(self.whole_features[np.argmax(self.adf[self.features])])

    @property
    def whole_features(self) -> IntArray:
        """Feature points among all vertices, (k,)."""
        return self.surface.kept[self.features]

    def prolonged(self, monitor: Monitor, order: IntArray | None = None) -> WholeFeatures:
        """Interpolate the features to all vertices. `order` (k,)."""
        features, cells, adf = self.whole_features, self.cells, self.adf
        if self.surface.coarse:
            fields = self.surface.prolong(np.column_stack([self.limbs.to_features, self.adf]))
            monitor.check()
            cells, adf = voronoi_cells(fields[:, :-1], features, self.joined_faces), fields[:, -1].copy()
        if order is None:
            return WholeFeatures(features, cells, adf, self.limbs)
        return WholeFeatures(features[order], np.argsort(order)[cells], adf, self.limbs.sorted_by(order))


def detected(
    points: FloatArray,
    faces: IntArray,
    chosen: IntArray | None,
    settings: Settings,
    monitor: Monitor,
    *,
    reduced: Reduced = working_surface,
    limbs: Limbs | None = None,
    names: Sequence[str] = (),
) -> SurfaceFeatures:
    """Reduce a surface to its working vertices, and find its feature points and patches.

    `points` (n, 3); `faces` (m, 3); `chosen` (k,); `settings`: options; `reduced`: reduces the surface, as
    `working_surface` does; joins the parts of a body into one surface; `limbs`: head, tail and sides among the chosen
    points, if they are known from another pose; `names`: of the chosen points, if they were given by hand.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[x, y, 0.0] for x in range(4) for y in (0, 1)])
    >>> faces = np.array([[i + a, i + 2, i + b] for i in range(0, 6, 2) for a, b in ((0, 1), (1, 3))])
    >>> found = detected(points, faces, np.array([0, 7]), Settings(), Monitor())
    >>> found.cells.tolist()
    [0, 0, 0, 0, 1, 1, 1, 1]

    References
    ----------
    The paper, section 4.
    """
    monitor.check()
    whole_points, centre, unit = of_unit_area(points, faces)
    target = settings.coarse_vertices
    reduction = monitor.kept(
        "coarse mesh",
        [points, faces, chosen, target, reduced],
        lambda: reduced(whole_points, faces, target, fixed=chosen, monitor=monitor),
    )
    if reduction.stuck:
        monitor.warn("coarse_mesh_stuck", count=len(reduction.points))
    surface, L, M, spectrum = monitor.kept(
        "spectrum", [reduction, settings.eigenpairs], lambda: _analysed(reduction, settings.eigenpairs, monitor)
    )
    with monitor.stage("Feature points"):
        adf = monitor.kept(
            "adf", [spectrum, settings.diffusion_time], lambda: auto_diffusion(spectrum, settings.diffusion_time)
        )
        features, to_features, prominence = monitor.kept(
            "maxima",
            [surface, adf, chosen, settings.prominence, settings.feature_count],
            lambda: _feature_points(adf, surface, chosen, settings, monitor),
        )
        monitor.check()

    def numbered() -> SurfaceFeatures:
        """Sort the feature points and grow the patches around them."""
        with monitor.stage("Feature points"):
            found = _in_lasting_order(features, to_features, prominence, adf, surface, monitor)
            if limbs is not None:
                found = found.like(limbs)
            found = with_names(found, names)
            if chosen is None and not settings.feature_count:
                warn_of_missing_limbs(found, monitor, joined=len(surface.bridges) > 0)
        with monitor.stage("Patches"):
            cells = voronoi_cells(found.to_features, found.features, surface.faces)
        return SurfaceFeatures(whole_points, faces, centre, unit, surface, L, M, spectrum, adf, cells, found)

    return monitor.kept(
        "features", [surface, adf, features, prominence, settings.feature_count, limbs, *names], numbered
    )


def _analysed(
    surface: WorkingSurface, eigenpairs: int, monitor: Monitor
) -> tuple[WorkingSurface, csr_matrix, FloatArray, Spectrum]:
    """Compute eigenpairs, on slightly longer edges where degenerate triangles disturb the solver."""
    with monitor.stage("Spectrum"):
        for slack in (0.0, *_MORE_SLACK):
            if slack:
                surface = surface.with_slack(slack, monitor)
            L, M = stiffness_and_mass(surface.triangulation)
            try:
                spectrum = compute_spectrum(L, M, eigenpairs, monitor)
                break
            except SolverError:
                if slack == _MORE_SLACK[-1]:
                    raise
    if slack:
        monitor.warn("flat_triangles", share=slack)
    if len(spectrum.eigenvalues) < eigenpairs:
        monitor.warn("few_eigenpairs")
    return surface, L, M, spectrum


def _feature_points(
    adf: FloatArray, surface: WorkingSurface, chosen: IntArray | None, settings: Settings, monitor: Monitor
) -> tuple[IntArray, FloatArray, FloatArray | None]:
    """Select the prominent maxima of the Auto Diffusion Function, and only the first of those close to each other."""
    fine = refined(surface.triangulation, FEWEST, monitor) if settings.whole else surface.triangulation
    heat = HeatMethod(fine, count=len(surface.points), monitor=monitor)
    if chosen is not None:
        features = surface.numbers_of(chosen)
        return features, heat.distances(features), None
    asked = 0.0 if settings.feature_count else settings.prominence
    features, prominence = prominent_maxima(adf, surface.faces, asked)
    if settings.feature_count:
        features = features[: _SPARE * settings.feature_count]
    monitor.check()
    to_features = heat.distances(features)
    kept = merged(features, to_features[features], _MERGED * float(to_features.max()))
    kept = kept[: settings.feature_count or None]
    if len(kept) < settings.feature_count:
        monitor.warn("few_features", count=len(kept))
    return features[kept], to_features[:, kept], prominence[kept]


def _in_lasting_order(
    features: IntArray,
    to_features: FloatArray,
    prominence: FloatArray | None,
    adf: FloatArray,
    surface: WorkingSurface,
    monitor: Monitor,
) -> Limbs:
    """Identify limbs and number them; those without a prominence were chosen by hand and keep their order."""
    between = (to_features[features] + to_features[features].T) / 2
    vertices = surface.kept[features]
    count = len(features)
    if count <= MOST_FEATURES:
        handedness = chirality(to_features, surface.faces)
    else:  # not needed, and its time and memory grow cubically
        handedness = np.broadcast_to(0.0, (count, count, count))

    def places() -> FloatArray:
        """Find the first vertex in the outer half of each limb: the tip of a limb depends on the pose."""
        far = surface.prolong(to_features) if surface.coarse else to_features
        nearest, least = np.argmin(far, axis=1), far.min(axis=1)
        first = np.zeros(count)
        for number in range(count):
            own = np.flatnonzero(nearest == number)
            outer = own[least[own] <= least[own].max(initial=0.0) / 2]
            first[number] = outer[0] if len(outer) else vertices[number]
        return first

    limbs = limbs_of(between, handedness, adf[features], places, joined=len(surface.bridges) > 0, monitor=monitor)
    limbs = limbs.on_surface(features, to_features)
    return limbs if prominence is None else limbs.sorted_by(lasting_order(limbs, prominence, vertices))
