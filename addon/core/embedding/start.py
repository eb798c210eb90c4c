"""The intrinsic start: how the limbs lie to each other, from the surface alone, and the surface in that arrangement."""

from __future__ import annotations

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..distances.spectral import biharmonic_squared
from ..mesh.geometry import signed_volume
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.spectrum import Spectrum
from .classical_scaling import landmark_scaling, least_squares_scaling

_BIHARMONIC_SHARE = 0.4  # of the squared distances; the rest is geodesic
_TIE, _SURE = 0.8, 1.6  # handedness below which the third axis is dropped, and above which it is kept whole
_PULL = 30.0  # 1/area: the layout shapes what is larger than a limb, the surface what is smaller
_MEMORY = 0.1  # of the bends of the pose
_STEPS = 18


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
    """
    squared = geodesic**2
    biharmonic = biharmonic_squared(spectrum, np.arange(len(geodesic)), landmarks)
    scale = np.vdot(biharmonic, squared) / np.vdot(biharmonic, biharmonic)
    return np.sqrt((1 - _BIHARMONIC_SHARE) * squared + _BIHARMONIC_SHARE * scale * biharmonic)


def laid_out(
    distances: FloatArray, landmarks: IntArray, points: FloatArray, faces: IntArray
) -> tuple[FloatArray, float]:
    """Lay the surface out in space by classical scaling, outside out, without choosing between mirror images.

    Distances don't know left from right. Where the layout encloses a volume, its sign tells the mirror images apart:
    the volume of a surface that is outside out is positive. Where it encloses next to none the images are a tie,
    which nothing but chance or the pose could break; there the third axis is dropped, and the flat layout is its own
    mirror image. In between the third axis is shortened, so that the layout depends continuously on the surface.

    Parameters
    ----------
    distances : (n, l) ndarray of float
        Distance of every vertex from each landmark.
    landmarks : (l,) ndarray of int
        The landmarks.
    points : (n, 3) ndarray of float
        The input, which tells whether the triangles face outwards.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    layout : (n, 3) ndarray of float
        The layout, along its principal axes.
    depth : float
        What the third axis is worth, from 0 where mirror images are a tie to 1 where they are none.
    """
    projected = landmark_scaling(distances, landmarks)
    projected -= projected.mean(axis=0)
    layout = least_squares_scaling(distances, landmarks, projected)
    handed = handedness(layout, faces) * np.sign(signed_volume(points, faces))
    sure = float(np.clip((abs(handed) - _TIE) / (_SURE - _TIE), 0.0, 1.0))
    if sure < 1:
        layout = least_squares_scaling(distances, landmarks, projected * [1.0, 1.0, sure], sure)
    return layout * [1.0, 1.0, np.sign(handed)], sure


def handedness(layout: FloatArray, faces: IntArray) -> float:
    """Measure how clearly a layout differs from its mirror image, and which of the two it is.

    Parameters
    ----------
    layout : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles, oriented outwards.

    Returns
    -------
    float
        Signed volume over the product of the deviations along the three axes; 0 for a flat layout. 4.2 for a solid
        ball (4π/3), near 0 for a body with thin limbs whose arrangement is a tie.
    """
    spread = float(np.prod(layout.std(axis=0)))
    return signed_volume(layout, faces) / spread if spread > 0 else 0.0


def inflated(body: ElasticBody, layout: FloatArray, monitor: Monitor) -> FloatArray:
    """Give the limbs of a layout, which classical scaling squashes, the roundness they have on the surface.

    Parameters
    ----------
    body : ElasticBody
        The input.
    layout : (n, 3) ndarray of float
        The layout.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    (n, 3) ndarray of float
        The start.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    return body.deformed_towards(layout, _PULL, _STEPS, _MEMORY, monitor)
