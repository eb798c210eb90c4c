"""A surface with its form and descriptors of its points, for any pose and triangulation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.geometry import vertex_normals
from ..method_api.surface_features import SurfaceFeatures
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.spectrum import compute_spectrum
from ..symmetry.limbs import Limbs
from ..symmetry.upright import facing

_BANDS = (40, 80)  # eigenfunctions to which the curvature is smoothed
_OUTLIERS = 0.02  # share of the curvatures at either end that are cut off
_EIGENPAIRS = 120  # of the map: with fewer, limbs rotate about their axes
_SIGNED, _ENERGIES = 80, 40  # eigenpairs of the wave kernel signature, and its energies,
_WIDTH = 7.0  # their width in steps


class Unfolded(NamedTuple):
    """A surface of unit area on its working vertices, and its form."""

    form: FloatArray  # (c, 3)
    faces: IntArray  # (d, 3)
    normals: FloatArray  # (c, 3) of the form
    areas: FloatArray  # (c,) of the vertices; their sum is 1
    eigenvectors: FloatArray  # (c, K) orthonormal under the areas, lowest first
    curvature: FloatArray  # (c, 2) mean curvature of the pose, smoothed over wide and over narrower neighbourhoods
    signature: FloatArray  # (c, 40) logarithm of the wave kernel signature, over the root of their number
    limbs: Limbs
    whole_form: FloatArray  # (n, 3) of all vertices
    found: SurfaceFeatures  # the pose, of unit area, and the interpolation to all vertices
    facing: float  # how surely the left limbs are those on the left, as in `upright.facing`

    @property
    def features(self) -> IntArray:
        """Feature points, (k,)."""
        return self.limbs.features


def unfolded(found: SurfaceFeatures, form: FloatArray, monitor: Monitor) -> Unfolded:
    """Compute the descriptors of the points of a surface.

    `found`: the surface, its spectrum and feature points; `form` (n, 3).

    References
    ----------
    Aubry, Schlickewei and Cremers, "The Wave Kernel Signature", 2011, doi:10.1109/ICCVW.2011.6130444.
    """
    surface, total = found.surface, found.mass.sum()
    here, areas = form[surface.kept], found.mass / total
    spectrum = found.spectrum
    if len(spectrum.eigenvalues) < min(_EIGENPAIRS, len(areas) - 1):
        spectrum = compute_spectrum(found.stiffness, found.mass, _EIGENPAIRS, monitor)
    eigenvectors = spectrum.eigenvectors[:, :_EIGENPAIRS] * np.sqrt(total)
    curvature = _mean_curvature(found)
    low, high = np.quantile(curvature, [_OUTLIERS, 1 - _OUTLIERS])
    waves = eigenvectors.T @ (areas * np.clip(curvature, low, high))
    smooth = [eigenvectors[:, :count] @ waves[:count] for count in _BANDS]
    return Unfolded(
        here,
        surface.faces,
        vertex_normals(here, surface.faces),
        areas,
        eigenvectors,
        np.column_stack(smooth),
        _signature(spectrum.eigenvalues[:_SIGNED], eigenvectors[:, :_SIGNED]),
        found.limbs,
        form,
        found,
        facing(here, areas, found.limbs),
    )


def _mean_curvature(found: SurfaceFeatures) -> FloatArray:
    """Compute the mean curvature of the pose, above 0 where it is convex."""
    points, faces = found.surface.points, found.surface.faces
    across = np.einsum("ij,ij->i", found.stiffness @ points, vertex_normals(points, faces))
    return np.asarray(across / (2 * found.mass))


def _signature(eigenvalues: FloatArray, eigenvectors: FloatArray) -> FloatArray:
    """Compute the logarithm of the wave kernel signature."""
    energy = np.log(np.maximum(eigenvalues, np.finfo(float).tiny))
    levels = np.linspace(energy[0], energy[-1], _ENERGIES)
    width = _WIDTH * max((energy[-1] - energy[0]) / _ENERGIES, np.finfo(float).tiny)
    shares = np.exp(-((levels[:, None] - energy) ** 2) / (2 * width**2))
    shares /= np.maximum(shares.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    return np.asarray(np.log(np.maximum(eigenvectors**2 @ shares.T, np.finfo(float).tiny)) / np.sqrt(_ENERGIES))
