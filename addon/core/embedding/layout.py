"""The layout: where the limbs lie by distances alone, and whether that tells a surface from its mirror image."""

from __future__ import annotations

import numpy as np

from ..mesh.geometry import signed_volume
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.ramps import ramp
from .classical_scaling import landmark_scaling, least_squares_scaling

_VOLUME = (0.8, 1.6)  # handedness below which mirror images are a tie, and above which they are none;
_VOLUME_OF_A_BOWL = (0.2, 0.4)  # likewise where a mirror exchanges left and right
_BOWL = (0.25, 0.45)  # misfit of a half turn, over that of the mirror and the half turn, from twisted to bowl
_LEAD = (0.005, 0.015)  # by how much the swap of left and right fits better than the next: below, it is none
_TOLD = (0.04, 0.08)  # both misfits together: below, the ends lie in a plane, and either exchanges them


def laid_out(
    distances: FloatArray,
    landmarks: IntArray,
    points: FloatArray,
    faces: IntArray,
    partner: IntArray,
    lead: float,
) -> tuple[FloatArray, float]:
    """Lay the surface out in space by classical scaling, outside out, without choosing between mirror images.

    Distances don't know left from right. Where the layout encloses a volume, its sign tells the mirror images apart:
    the volume of a surface that is outside out is positive. Where they are a tie, which nothing but chance or the pose
    could break, the third axis is dropped, and the flat layout is its own mirror image. In between the third axis is
    shortened, so that the layout depends continuously on the surface.

    Parameters
    ----------
    distances : (n, l) ndarray of float
        Distance of every vertex from each landmark.
    landmarks : (l,) ndarray of int
        The landmarks, the feature points first.
    points : (n, 3) ndarray of float
        The input, which tells whether the triangles face outwards.
    faces : (m, 3) ndarray of int
        Triangles.
    partner : (k,) ndarray of int
        The mirror partner of each feature point; itself for those in the middle, and for all if there is no left and
        right.
    lead : float
        By how much the swap with the partners fits better than the next best.

    Returns
    -------
    layout : (n, 3) ndarray of float
        The layout, along its principal axes.
    depth : float
        What the third axis is worth, from 0 where mirror images are a tie to 1 where they are none.

    Examples
    --------
    >>> from scipy.spatial.distance import cdist
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> layout, depth = laid_out(cdist(points, points), np.arange(4), points, faces, np.arange(4), 0.0)
    >>> depth, np.allclose(cdist(layout, layout), cdist(points, points))
    (1.0, True)
    """
    projected = landmark_scaling(distances, landmarks)
    projected -= projected.mean(axis=0)
    layout = least_squares_scaling(distances, landmarks, projected)
    handed = handedness(layout, faces) * np.sign(signed_volume(points, faces))
    ends = layout[landmarks[: len(partner)]] - layout.mean(axis=0)
    sure = certainty(abs(handed), ends, partner, lead)
    if sure < 1:
        layout = least_squares_scaling(distances, landmarks, projected * [1.0, 1.0, sure], depth=sure)
    return layout * [1.0, 1.0, np.sign(handed)], sure


def handedness(layout: FloatArray, faces: IntArray) -> float:
    """Measure how much volume a layout encloses, and whether it is outside out.

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
        ball (4π/3), below 1 for a body whose limbs are thin.

    Examples
    --------
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> round(handedness(points, faces), 6), round(handedness(points * [1, 1, -1], faces), 6)
    (2.666667, -2.666667)
    """
    spread = float(np.prod(layout.std(axis=0)))
    return signed_volume(layout, faces) / spread if spread > 0 else 0.0


def certainty(volume: float, ends: FloatArray, partner: IntArray, lead: float) -> float:
    """Judge how surely a layout is told from its mirror image.

    A surface with a left and a right is its own mirror image, and so must its layout be. Either a mirror exchanges
    left and right: the layout is a bowl, all limbs on one side of the trunk, and a volume tells its outside. Or a half
    turn does: the layout is twisted, arms against legs. Then it could as well be twisted the other way, whatever its
    volume, and the pose would choose: a tie. Without left and right, or with all ends in one plane, only the volume
    tells; likewise where another swap of the ends fits nearly as well.

    Parameters
    ----------
    volume : float
        Handedness of the layout, without its sign.
    ends : (k, 3) ndarray of float
        Feature points in the layout, from its centroid.
    partner : (k,) ndarray of int
        The mirror partner of each; itself for those in the middle, and for all if there is no left and right.
    lead : float
        By how much the swap with the partners fits better than the next best.

    Returns
    -------
    float
        From 0 (a tie) to 1.

    Examples
    --------
    >>> ends = np.array([[1.0, 1, 1], [-1, -1, 1], [1, -1, -1], [-1, 1, -1]])
    >>> certainty(2.7, ends, np.array([1, 0, 3, 2]), 0.1), certainty(2.7, ends, np.array([1, 0, 2, 3]), 0.1)
    (0.0, 1.0)
    """
    by_volume = float(ramp(volume, *_VOLUME))
    if np.array_equal(partner, np.arange(len(partner))):
        return by_volume
    mirror, half_turn = _misfits(ends, ends[partner])
    told = float(ramp(mirror + half_turn, *_TOLD) * ramp(lead, *_LEAD))
    if told == 0:
        return by_volume
    bowl = float(ramp(half_turn / (mirror + half_turn), *_BOWL))
    return told * bowl * float(ramp(volume, *_VOLUME_OF_A_BOWL)) + (1 - told) * by_volume


def _misfits(ends: FloatArray, images: FloatArray) -> tuple[float, float]:
    """Compute how far the best reflection and the best rotation of points are from images, squared, over their size."""
    left, stretch, right = np.linalg.svd(ends.T @ images)
    size = float((ends**2).sum())
    if size == 0:
        return 0.0, 0.0
    best = 2 * (size - stretch.sum()) / size  # of the two
    other = best + 4 * stretch[2] / size
    return (best, other) if np.linalg.det(left @ right) < 0 else (other, best)
