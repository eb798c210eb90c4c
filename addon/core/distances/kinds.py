"""The kinds of distance that can be measured from vertices, declared once for scripts and panels."""

from __future__ import annotations

from typing import NamedTuple


class DistanceKind(NamedTuple):
    """A kind of distance.

    Attributes
    ----------
    label : str
        Its name in a panel and of the colours that show it.
    help : str
        One line about it.
    spectral : bool
        Whether it is computed on a coarse mesh, from all pairs of its vertices.
    """

    label: str
    help: str
    spectral: bool = False


KINDS = {
    "heat": DistanceKind("Heat Geodesic", "Length of the shortest path on the surface, by the heat method"),
    "fast_marching": DistanceKind("Fast Marching", "Length of the shortest path on the surface, by fast marching"),
    "biharmonic": DistanceKind("Biharmonic Distance", "Smooth distance that depends on the global shape", True),
    "commute_time": DistanceKind(
        "Commute Time", "Expected length of a random walk there and back; depends on all paths", True
    ),
}
