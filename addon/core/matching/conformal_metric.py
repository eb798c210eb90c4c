"""A surface whose metric is scaled so that it has the areas of another: eigenfunctions of unlike bodies agree."""

from __future__ import annotations

import numpy as np

from ..mesh.geometry import vertex_areas
from ..numerics.arrays import IntArray
from ..run.monitor import Monitor
from ..surface.spectrum import compute_spectrum
from .unfolded import Unfolded

_SMOOTH = 20  # eigenfunctions of the scale
_LEAST = 0.05  # scale below which triangles count as collapsed by the map


def with_areas_of(one: Unfolded, other: Unfolded, partner: IntArray, monitor: Monitor) -> Unfolded:
    """Scale the metric of a surface so that its parts have the areas of their images on another.

    A map between eigenfunctions takes equal areas to equal areas: the long trunk of a gorilla slides to the thighs of
    a man. In two dimensions the Laplacian of a scaled metric is that of the metric over the scale, so that only the
    masses change; under a conformal map the eigenfunctions are then those of the other surface.

    `one, other`: the surfaces; `partner` (c,): a map between their vertices, which tells the scale.

    Examples
    --------
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> from addon.core.matching.unfolded import unfolded
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> np.allclose(with_areas_of(body, body, np.arange(4), Monitor()).areas, body.areas)
    True

    References
    ----------
    Shi, Lai, Wang, Pelletier, Mohr, Sicotte and Toga, "Metric Optimization for Surface Analysis in the Laplace-Beltrami
    Embedding Space", 2014, doi:10.1109/TMI.2014.2313812.
    """
    own = vertex_areas(one.found.surface.points, one.faces)  # of the same kind, which masses are not
    image = vertex_areas(other.found.surface.points[partner], one.faces)
    scale = np.log(np.maximum(image / own, _LEAST))
    waves = one.eigenvectors[:, :_SMOOTH]
    areas = one.areas * np.exp(waves @ (waves.T @ (one.areas * scale)))
    areas /= areas.sum()
    spectrum = compute_spectrum(one.found.stiffness, areas, one.eigenvectors.shape[1], monitor)
    return one._replace(areas=areas, eigenvectors=spectrum.eigenvectors)
