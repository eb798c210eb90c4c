"""Draws meshes and results into matplotlib axes, for notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..core.results import CanonicalForm
from .pictures import drawn, upright

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_GREY = (205.0, 205.0, 212.0)
_SIZE = 320  # pixels


def plot(
    mesh: CanonicalForm | ArrayLike,
    faces: ArrayLike | None = None,
    *,
    values: ArrayLike | None = None,
    patches: ArrayLike | None = None,
    turn: ArrayLike | None = None,
    axes: Axes | None = None,
    title: str = "",
    size: int = _SIZE,
) -> Axes:
    """Draw a form, or any mesh, coloured by its patches or by a value at every vertex.

    Parameters
    ----------
    mesh : CanonicalForm or (n, 3) array_like of float
        A form, which brings its faces and patches, or vertices.
    faces : (m, 3) array_like of int, optional
        Triangles, if `mesh` is vertices.
    values : (n,) array_like of float, optional
        A value at every vertex, such as a distance; vertices without a number are grey.
    patches : (n,) array_like of int, optional
        The patch of every vertex, -1 for none.
    turn : (3, 3) array_like of float, optional
        Rotation before drawing, ``x ↦ x R``, to a view along the third axis; the widest view if omitted.
    axes : matplotlib.axes.Axes, optional
        Where; a new figure if omitted.
    title : str
        What is written above.
    size : int
        Width and height of the picture in pixels.

    Returns
    -------
    matplotlib.axes.Axes
        Those that were drawn into.

    Raises
    ------
    ImportError
        If matplotlib is not installed: it is no requirement of this package.
    ValueError
        If there are no faces, or not one value for each vertex.

    Examples
    --------
    >>> from addon.core import canonical_form, mannequin
    >>> form = canonical_form(*mannequin(), quality="draft")  # doctest: +SKIP
    >>> plot(form, title="the form").get_title()  # doctest: +SKIP
    'the form'
    """
    import matplotlib as mpl
    from matplotlib import pyplot

    given_points: Any = mesh
    if isinstance(mesh, CanonicalForm):
        given_points, faces, patches = mesh.vertices, mesh.faces, mesh.patches if values is None else None
    points, corners = np.asarray(given_points, dtype=np.float64), np.asarray(faces)
    if faces is None or corners.ndim != 2:
        raise ValueError("Give the faces of the mesh, too.")
    shown: Any = np.tile(_GREY, (len(points), 1))
    for each, kind in ((values, np.float64), (patches, np.int64)):
        if each is None:
            continue
        given = np.asarray(each, dtype=kind)
        if given.shape != (len(points),):
            raise ValueError(f"Give one value for each of the {len(points)} vertices; got shape {given.shape}.")
        known = np.isfinite(given) if kind is np.float64 else given >= 0
        shown[known] = 255 * (_scale(mpl, given[known]) if kind is np.float64 else _palette(mpl, given[known]))
    rotation = upright(points) if turn is None else np.asarray(turn, dtype=np.float64)
    if axes is None:
        axes = pyplot.subplots(figsize=(size / 100, size / 100))[1]
    axes.imshow(drawn(points, corners.astype(np.int64), rotation, size, shown))
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)
    return axes


def _scale(mpl: Any, values: np.ndarray) -> np.ndarray:
    """Colour values from the lowest to the highest, (k, 3)."""
    low, high = (values.min(), values.max()) if len(values) else (0.0, 1.0)
    colours: np.ndarray = mpl.colormaps["viridis"]((values - low) / max(high - low, 1e-300))[:, :3]
    return colours


def _palette(mpl: Any, patches: np.ndarray) -> np.ndarray:
    """Colour patches, (k, 3)."""
    colours: np.ndarray = mpl.colormaps["tab10"](patches % 10)[:, :3]
    return colours
