"""The start of the minimisation: how the limbs lie to each other, from the surface alone or from the input."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..distances.farthest_points import farthest_points
from ..distances.heat import HeatMethod
from ..distances.spectral import GreensFunction, biharmonic_squared
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.spectrum import Spectrum
from ..surface.triangulation import Triangulation
from .layout import laid_out
from .pairs import arrangement_pairs, feature_pairs
from .stress import PairSet

_BIHARMONIC_SHARE = 0.4  # of the squared distances; the rest is geodesic
_PULL = 30.0  # 1/area: the layout shapes what is larger than a limb, the surface what is smaller
_BENDING_WEIGHT = 0.1  # of the bends of the pose
_LAYOUT_SMOOTHING = 0.02  # diffusion time of the landmarks' geodesics over that of the patches
_FEATURE_SHARE = 0.03  # of the feature points alone, from the input; far more would pull spikes out of the surface


@dataclass(frozen=True, eq=False)
class Start:
    """Where the minimisation starts, and what is wanted between the patches.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        First embedding of the vertices.
    between : PairSet or None
        Pairs between patches, not yet balanced against those inside; None where one patch is all there is.
    share : float
        Weight of those pairs, over the weight with which the patches hold the same vertices.
    landmarks : (l,) ndarray of int
        Vertices that those pairs join.
    depth : float
        What the third axis is worth: 0 where mirror images are a tie, 1 where they are none.
    """

    points: FloatArray
    between: PairSet | None
    share: float
    landmarks: IntArray
    depth: float


def intrinsic_start(
    triangulation: Triangulation,
    spectrum: Spectrum,
    body: ElasticBody,
    faces: IntArray,
    features: IntArray,
    to_features: FloatArray,
    partner: IntArray,
    lead: float,
    *,
    landmark_count: int = 100,
    smoothing: float = 0.1,
    share: float = 10.0,
    steps: int,
    monitor: Monitor,
) -> Start:
    """Arrange the limbs from the surface alone, and deform the input into that arrangement.

    Landmarks are spread over the surface, the feature points first. Classical scaling of the distances between them,
    followed by least squares, lays them out; the input is deformed towards that layout.

    Parameters
    ----------
    triangulation : Triangulation
        The surface, Delaunay, of unit area.
    spectrum : Spectrum
        Its eigenpairs.
    body : ElasticBody
        The input.
    faces : (m, 3) ndarray of int
        Triangles in space.
    features : (k,) ndarray of int
        Feature points.
    to_features : (n, k) ndarray of float
        Geodesic distances from them.
    partner : (k,) ndarray of int
        The mirror partner of each; itself for those in the middle, and for all if there is no left and right.
    lead : float
        By how much the swap with the partners fits better than the next best.
    landmark_count : int
        Number of landmarks.
    smoothing : float
        Diffusion time of the geodesics inside patches; those between landmarks have a fiftieth of it. 0: geodesics
        alone, without biharmonic distances.
    share : float
        As in `Start`.
    steps : int
        Number of steps that restore the roundness of the limbs.
    monitor : Monitor
        Receives progress (stages *Landmarks* and *Start*); polled for cancellation.

    Returns
    -------
    Start
        The surface in its arrangement; between the patches the distances there are wanted.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / 192**0.25
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> surface, spectrum = triangulated(points, faces), Spectrum(np.full(3, 9.2), points)
    >>> body, first = ElasticBody(surface, points, faces), np.array([0])
    >>> start = intrinsic_start(
    ...     surface, spectrum, body, faces, first, np.ones((4, 1)), np.arange(1), 0.0, steps=2, monitor=Monitor())
    >>> sorted(start.landmarks.tolist())
    [0, 1, 2, 3]

    References
    ----------
    De Silva and Tenenbaum, "Sparse multidimensional scaling using landmark points", 2004.
    """
    with monitor.stage("Landmarks"):
        heat = HeatMethod(triangulation, _LAYOUT_SMOOTHING * smoothing or None, refine=False, monitor=monitor)
        landmarks, distances = farthest_points(
            heat, features, heat.distances(features), landmark_count, monitor=monitor
        )
        if smoothing > 0:
            distances = landmark_distances(distances, landmarks, spectrum)
    with monitor.stage("Start"):
        layout, depth = laid_out(distances, landmarks, body.points, faces, partner, lead)
        monitor.check()
        points = inflated(body, layout, steps, monitor)
    return Start(points, arrangement_pairs(landmarks, points), share, landmarks, depth)


def input_start(
    points: FloatArray, features: IntArray, to_features: FloatArray, green: GreensFunction, adf: FloatArray
) -> Start:
    """Start from the input, whose pose the form then keeps in part.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        The input.
    features : (k,) ndarray of int
        Feature points.
    to_features : (n, k) ndarray of float
        Geodesic distances from them.
    green : GreensFunction
        For biharmonic distances.
    adf : (n,) ndarray of float
        Auto Diffusion Function.

    Returns
    -------
    Start
        The input; between the feature points biharmonic distances are wanted, in the measure of geodesic ones.

    Examples
    --------
    >>> from scipy.sparse import csr_matrix
    >>> green = GreensFunction(csr_matrix([[1.0, -1], [-1, 1]]), np.ones(2))
    >>> apart = np.array([[0.0, 3], [3, 0]])
    >>> start = input_start(np.eye(2, 3), np.arange(2), apart, green, np.ones(2))
    >>> start.between.targets[0].round(6).tolist()
    [[0.0, 3.0], [3.0, 0.0]]

    References
    ----------
    The paper, equation 10.
    """
    if len(features) == 1:
        return Start(points, None, 0.0, features, 1.0)
    biharmonic = green.biharmonic_distances(features)
    scale = float(np.vdot(biharmonic, to_features[features]) / np.vdot(biharmonic, biharmonic))  # s, by least squares
    return Start(points, feature_pairs(features, scale * biharmonic, adf), _FEATURE_SHARE, features, 1.0)


def landmark_distances(geodesic: FloatArray, landmarks: IntArray, spectrum: Spectrum) -> FloatArray:
    """Combine geodesic and biharmonic distances from the landmarks.

    Geodesics know how long a limb is but shorten around a bent joint; biharmonic distances (equation 9) hardly feel
    the bend but are too short for thin limbs. The squares are averaged, the biharmonic ones in the measure of the
    geodesic ones (s by least squares).

    Parameters
    ----------
    geodesic : (n, l) ndarray of float
        Geodesic distance of every vertex from each landmark.
    landmarks : (l,) ndarray of int
        The landmarks.
    spectrum : Spectrum
        The eigenpairs.

    Returns
    -------
    (n, l) ndarray of float
        Distances, lengths.

    Examples
    --------
    >>> line = np.array([[0.0], [1.0], [3.0]])
    >>> landmark_distances(2 * line, np.array([0]), Spectrum(np.ones(1), line)).ravel().round(6).tolist()
    [0.0, 2.0, 6.0]
    """
    squared = geodesic**2
    biharmonic = biharmonic_squared(spectrum, np.arange(len(geodesic)), landmarks)
    scale = np.vdot(biharmonic, squared) / np.vdot(biharmonic, biharmonic)
    return np.sqrt((1 - _BIHARMONIC_SHARE) * squared + _BIHARMONIC_SHARE * scale * biharmonic)


def inflated(body: ElasticBody, layout: FloatArray, steps: int, monitor: Monitor) -> FloatArray:
    """Restore the roundness of the limbs, which classical scaling flattens in a layout.

    Parameters
    ----------
    body : ElasticBody
        The input.
    layout : (n, 3) ndarray of float
        The layout.
    steps : int
        Number of steps.
    monitor : Monitor
        Receives progress; polled for cancellation.

    Returns
    -------
    (n, 3) ndarray of float
        The start.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> np.allclose(inflated(body, points, 18, Monitor()), points)
    True
    """
    return body.deformed_towards(layout, pull=_PULL, steps=steps, bending_weight=_BENDING_WEIGHT, monitor=monitor)
