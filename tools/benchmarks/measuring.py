"""What the experiments measure with: seconds, and exact geodesics to compare with."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np


def timed(function: Callable, *arguments: Any, **options: Any) -> tuple[Any, float]:
    """Return the result of a function, and its seconds."""
    began = time.perf_counter()
    return function(*arguments, **options), time.perf_counter() - began


def exact_distances(vertices: np.ndarray, faces: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """Return the geodesic distances of all vertices from each source, (n, s), exact, by pygeodesic."""
    from pygeodesic.geodesic import PyGeodesicAlgorithmExact

    exact = PyGeodesicAlgorithmExact(vertices, faces)
    return np.stack([exact.geodesicDistances(np.array([source]))[0] for source in sources], axis=1)


def library_seconds(vertices: np.ndarray, faces: np.ndarray, sources: int = 100) -> float:
    """Return the seconds of potpourri3d's heat method: its factorisation, and a number of sources (by the mean of 20).

    The unit of times in the tables: seconds depend on the machine, and on what else it does.
    """
    import potpourri3d

    solver, factored = timed(potpourri3d.MeshHeatMethodDistanceSolver, vertices, faces)
    some = np.linspace(0, len(vertices) - 1, 20).astype(int)
    _, taken = timed(lambda: [solver.compute_distance(int(source)) for source in some])
    return factored + sources * taken / len(some)
