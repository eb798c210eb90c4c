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
    memory : (float, float) or None
        Gigabytes that it takes, and by vertex; None where they grow with the factors of the heat method.
    """

    label: str
    help: str
    spectral: bool = False
    memory: tuple[float, float] | None = None


KINDS = {
    "heat": DistanceKind("Heat Geodesic", "Length of the shortest path on the surface, by the heat method"),
    "fast_marching": DistanceKind(
        "Fast Marching", "Length of the shortest path on the surface, by fast marching", memory=(0.05, 0.75e-6)
    ),
    "biharmonic": DistanceKind(
        "Biharmonic Distance",
        "Smooth distance that depends on the global shape",
        spectral=True,
        memory=(0.1, 1.05e-6),
    ),
    "commute_time": DistanceKind(
        "Commute Time",
        "Expected length of a random walk there and back; depends on all paths",
        spectral=True,
        memory=(0.1, 1.05e-6),
    ),
}
