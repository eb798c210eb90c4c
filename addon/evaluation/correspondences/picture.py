"""Draws matches: colours transferred from one mesh to another, and the transferred pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ...core.mesh.geometry import surface_area
from ...core.numerics.arrays import FloatArray
from ..pictures import drawn, upright
from .matchers import Matcher, Mesh
from .pairs import Pair, Poses
from .work import remeshed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_ROWS = 8
_BANDS = 12  # stripes of each colour, whose edges show errors of a match
_DARK = 0.6  # brightness of every other stripe


class Matched(Protocol):
    """A pair with its result."""

    @property
    def pair(self) -> Pair:
        """The pair."""

    @property
    def matcher(self) -> Matcher:
        """The method of matching."""

    @property
    def outcome(self) -> Any:
        """Figures and arrays."""


def matches_figure(results: Sequence[Matched], matchers: Sequence[Matcher], poses: Poses) -> Figure | None:
    """Draw the pair with the median error of each class.

    Parameters
    ----------
    results : sequence of Matched
        Pairs with a match.
    matchers : sequence of Matcher
        The methods of matching.
    poses : Poses
        The meshes.

    Returns
    -------
    matplotlib.figure.Figure or None
        Rows of pairs: the other mesh with its colours, the colours transferred by each method, the transferred pose;
        None if there is nothing to show.
    """
    from matplotlib.figure import Figure

    pairs = [
        _middle([each for each in results if each.pair.label == label])
        for label in list(dict.fromkeys(each.pair.label for each in results))[:_MOST_ROWS]
    ]
    if not pairs:
        return None
    titles = ["colours", *(each.name for each in matchers), "pose taken over"]
    figure = Figure(figsize=(2 * len(titles), 2 * len(pairs)), layout="constrained")
    grid = figure.subplots(len(pairs), len(titles), squeeze=False)
    for axes, title in zip(grid[0], titles, strict=True):
        axes.set_title(title, fontsize=9)
    for row, pair in zip(grid, pairs, strict=True):
        one, other = poses.mesh(pair.one), poses.mesh(pair.other)
        reference = remeshed(other)
        colours = _stripes(reference)
        _show(row[0], reference, colours)
        row[0].text(-0.05, 0.5, pair.label, transform=row[0].transAxes, ha="right", va="center", fontsize=9)
        for axes, matcher in zip(row[1:-1], matchers, strict=True):
            found = next((each for each in results if (each.pair, each.matcher) == (pair, matcher)), None)
            if found is not None:
                arrays = found.outcome[1]
                carried = np.einsum("ij,ijk->ik", arrays["weights"], colours[arrays["corners"]])
                _show(axes, one, carried)
                if "posed" in arrays:
                    _show(row[-1], Mesh(arrays["posed"].astype(np.float64), one.faces), None, upright(other.vertices))
        for axes in row:
            axes.set_axis_off()
    return figure


def _middle(results: Sequence[Matched]) -> Pair:
    """Return the pair with the median error of the first method."""
    first = [each for each in results if each.matcher == results[0].matcher]
    order = np.argsort([each.outcome[0]["error"] for each in first], kind="stable")
    return first[order[len(order) // 2]].pair


def _stripes(mesh: Mesh) -> FloatArray:
    """Colour a mesh by position, in stripes."""
    extent = np.maximum(np.ptp(mesh.vertices, axis=0), np.finfo(float).tiny)
    place = (mesh.vertices - mesh.vertices.min(axis=0)) / extent
    odd = np.floor(_BANDS * place @ upright(mesh.vertices)[:, 1]) % 2
    return 255.0 * place * np.where(odd == 1, _DARK, 1.0)[:, None]


def _show(axes: Any, mesh: Mesh, colours: FloatArray | None, turn: FloatArray | None = None) -> None:
    """Draw one mesh."""
    size = np.sqrt(surface_area(*mesh))
    turn = upright(mesh.vertices) if turn is None else turn
    axes.imshow(drawn(mesh.vertices / size, mesh.faces, turn, 260, colours))
