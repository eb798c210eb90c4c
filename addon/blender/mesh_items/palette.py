"""Colours of fields and patches: a perceptual colour map for values, a palette for patches.

Both are defined in OKLab, where equal distances look equally different (Ottosson, "A perceptual color space for image
processing", 2020). The palette also suits colour-blind users (Machado, Oliveira and Fernandes, "A
Physiologically-based Model for Simulation of Color Vision Deficiency", 2009, doi:10.1109/TVCG.2009.113).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...core.mesh.edges import vertex_pairs
from ...core.numerics.arrays import FloatArray, IntArray

_TO_CONE = np.array(
    [[1.0, 0.3963377774, 0.2158037573], [1.0, -0.1055613458, -0.0638541728], [1.0, -0.0894841775, -1.2914855480]]
)
_TO_RGB = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)
_FROM_RGB = np.linalg.inv(_TO_RGB)
_FROM_CONE = np.linalg.inv(_TO_CONE)
_VISIONS = np.array(  # linear colours as seen with normal vision, and without the first, second or third kind of cone
    [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ]
)
_LIGHTNESS = np.array([0.70, 0.48, 0.92, 0.59, 0.81])
_GREY = np.array([0.2, 0.2, 0.2, 1.0])
_GOLDEN_TURN = 0.618033988749895
_MOST_CHOICES = 600  # candidate colours
_ENOUGH = 0.05  # distance between the colours of two patches, in OKLab


@dataclass(frozen=True, eq=False)
class Colours:
    """Colours of a result, computed without Blender.

    Attributes
    ----------
    field : (n, 4) ndarray of float32
        Colours of the Auto Diffusion Function.
    patches : (n, 4) ndarray of float32
        Colours of the patches, by vertex.
    palette : list of list of float
        Red, green and blue of each patch.
    """

    field: np.ndarray
    patches: np.ndarray
    palette: list[list[float]]

    def named(self, name: str) -> np.ndarray | None:
        """Return the colours of a field, 'adf' or 'patches'; None for 'none'.

        Parameters
        ----------
        name : {'none', 'patches', 'adf'}
            The field.

        Returns
        -------
        (n, 4) ndarray of float32 or None
            Its colours, by vertex.
        """
        return {"adf": self.field, "patches": self.patches}.get(name)


def colours_of(adf: FloatArray, patches: IntArray, faces: IntArray) -> Colours:
    """Colour the Auto Diffusion Function and the patches.

    Parameters
    ----------
    adf : (n,) ndarray of float
        Auto Diffusion Function, positive; 0 at vertices of no patch.
    patches : (n,) ndarray of int
        Patch of every vertex, from 0; -1 for none, shown in grey.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    Colours
        Linear colours.
    """
    palette = patch_colours(patches, faces)
    field = ramp(np.log(np.where(patches < 0, np.nan, adf)))
    shown = np.vstack([palette, _GREY])[patches]  # -1, no patch, is the last
    return Colours(field.astype(np.float32), shown.astype(np.float32), palette[:, :3].round(6).tolist())


def ramp(values: FloatArray) -> FloatArray:
    """Map values to colours from dark blue (lowest) over green to light yellow (highest), with lightness rising evenly.

    Parameters
    ----------
    values : (n,) ndarray of float
        A field; its range is mapped to the whole ramp. Values that are not finite become grey.

    Returns
    -------
    (n, 4) ndarray of float
        Linear red, green, blue and alpha 1.
    """
    share = _share_of_range(values)
    hue = np.deg2rad(290.0 - 180.0 * share)
    chroma = 0.09 + 0.07 * share
    colours = _linear(np.column_stack([0.28 + 0.64 * share, chroma * np.cos(hue), chroma * np.sin(hue)]))
    return np.where(np.isfinite(values)[:, None], colours, _GREY)


def places(points: FloatArray) -> FloatArray:
    """Colour points by their positions, one channel per axis.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        The points; their range is mapped to the full range of colours.

    Returns
    -------
    (n, 3) ndarray of float
        Linear red, green and blue, at least 0.05.

    Examples
    --------
    >>> places(np.array([[0.0, 0, 0], [1, 2, 3]])).round(2).tolist()
    [[0.05, 0.05, 0.05], [1.0, 1.0, 1.0]]
    """
    low, high = points.min(axis=0), points.max(axis=0)
    share = (points - low) / np.maximum(high - low, np.finfo(float).tiny)
    return np.asarray(0.05 + 0.95 * share)


def with_isolines(colours: FloatArray, values: FloatArray, count: int) -> FloatArray:
    """Darken every other band between isolines, so that the isolines are visible.

    Parameters
    ----------
    colours : (n, 4) ndarray of float
        Linear red, green, blue and alpha.
    values : (n,) ndarray of float
        The field that the colours show.
    count : int
        Number of isolines over its range.

    Returns
    -------
    (n, 4) ndarray of float
        The banded colours.
    """
    band = np.floor((count + 1) * _share_of_range(values))
    result = colours.copy()
    result[band % 2 == 1, :3] *= 0.45
    return result


def patch_colours(patches: IntArray, faces: IntArray) -> FloatArray:
    """Colour patches so that neighbours look different.

    Parameters
    ----------
    patches : (n,) ndarray of int
        Patch of every vertex, from 0; -1 for none.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (k, 4) ndarray of float
        Linear red, green, blue and alpha 1, one row for each patch.
    """
    count = int(patches.max()) + 1
    turns = np.arange(min(max(5 * count, 60), _MOST_CHOICES))
    hue = 2 * np.pi * (0.08 + turns * _GOLDEN_TURN)
    chroma = np.column_stack([np.cos(hue), np.sin(hue)]) * 0.13
    choices = _linear(np.column_stack([_LIGHTNESS[turns % len(_LIGHTNESS)], chroma]))
    looks = as_seen(choices[:, :3])
    ends = patches[vertex_pairs(faces)]
    neighbours = np.unique(ends[ends[:, 0] != ends[:, 1]], axis=0)
    neighbours = neighbours[neighbours.min(axis=1) >= 0]
    taken: list[int] = []
    distance = np.full(len(choices), 1.0)  # of every candidate from the nearest chosen colour
    for patch in range(count):
        beside = np.unique(neighbours[(neighbours == patch).any(axis=1)])
        near = [taken[other] for other in beside[beside < patch]]
        gaps = np.linalg.norm(looks[:, :, None] - looks[:, None, near], axis=-1).min(axis=(0, 2), initial=1.0)
        both = np.minimum(distance, gaps)
        taken.append(int(np.argmax(both if both.max() > _ENOUGH else gaps)))  # of many, only neighbours matter
        # patches that do not touch may be more alike
        apart = np.linalg.norm(looks - looks[:, taken[-1:]], axis=-1).min(axis=0)
        distance = np.minimum(distance, 2 * apart)
    return choices[taken]


def as_seen(colours: FloatArray) -> FloatArray:
    """Simulate how colours look with normal vision, and without each of the three kinds of cones.

    Parameters
    ----------
    colours : (n, 3) ndarray of float
        Linear red, green and blue.

    Returns
    -------
    (4, n, 3) ndarray of float
        In OKLab: with all cones; without long-wave, middle-wave and short-wave cones.
    """
    seen = np.clip(colours @ _VISIONS.transpose(0, 2, 1), 0.0, 1.0)
    lab: FloatArray = np.cbrt(seen @ _FROM_RGB.T) @ _FROM_CONE.T
    return lab


def _share_of_range(values: FloatArray) -> FloatArray:
    """Scale values to 0 for the lowest and 1 for the highest; values that are not finite become 0."""
    known, share = np.isfinite(values), np.zeros(len(values))
    if known.any():
        spread = float(np.ptp(values[known]))
        share[known] = (values[known] - values[known].min()) / (spread if spread > 0 else 1.0)
    return share


def _linear(oklab: FloatArray) -> FloatArray:
    rgb = (oklab @ _TO_CONE.T) ** 3 @ _TO_RGB.T
    return np.column_stack([np.clip(rgb, 0.0, 1.0), np.ones(len(rgb))])
