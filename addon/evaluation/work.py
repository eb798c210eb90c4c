"""The tasks of a worker: one form and its measures, or the Hausdorff distances of one shape from others."""

from __future__ import annotations

import sys
import time
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..core import CanonicalFormError, Settings, canonical_form
from ..core.measures.detail_kept import detail_measures
from ..core.measures.form_measures import edge_stretch, hausdorff, summary
from ..core.method_api.catalogue import DETECTION, method_named
from ..core.numerics.arrays import FloatArray, IntArray
from .descriptor import harmonic_descriptor
from .methods import Method
from .pair_descriptor import pair_descriptor


@dataclass(frozen=True, eq=False)
class Outcome:
    """Result for one shape and one method.

    Attributes
    ----------
    row : dict
        Figures that are bitwise reproducible for a mesh and settings; ``error`` with the reason after a failure.
    cost : dict
        Figures that differ between runs: ``seconds`` of the method alone, ``all_seconds`` including the measures,
        ``memory`` in megabytes (None if unknown).
    form : (n, 3) ndarray of float32 or None
        The form.
    descriptor, pairs : (d,) ndarray of float or None
        The form's descriptors, by spherical harmonics and by pairs of points.
    """

    row: dict[str, Any]
    cost: dict[str, float | None]
    form: np.ndarray | None = None
    descriptor: FloatArray | None = None
    pairs: FloatArray | None = None


def measured(vertices: FloatArray, faces: IntArray, method: Method) -> Outcome:
    """Compute one form on one thread and measure it.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        The mesh.
    faces : (m, 3) ndarray of int
        Its triangles.
    method : Method
        The method.

    Returns
    -------
    Outcome
        The figures; an error of the method is included.

    Raises
    ------
    MemoryError
        If this machine has too little memory; another machine may have enough.
    """
    began = time.perf_counter()
    peak = _Peak()
    seconds = 0.0
    row: dict[str, Any] = {"vertices": len(vertices), "faces": len(faces)}
    form, described, pairs = None, None, None
    try:
        with one_thread():
            after, faces, patches, row_of_form, seconds = _computed(vertices, faces, method.settings)
            memory = peak.megabytes()
            row |= row_of_form
            figures = summary(vertices, after, faces) | detail_measures(vertices, after, faces, patches)
            figures["scale"] = float(np.median(edge_stretch(vertices, after, faces)))
            row |= {name: _plain(value) for name, value in figures.items()}
            described, pairs = harmonic_descriptor(after, faces), pair_descriptor(after, faces)
            form = (after - after.mean(axis=0)).astype(np.float32)  # its position has no meaning and costs digits
    except CanonicalFormError as error:
        row["error"] = " ".join(str(error).split())
        memory = peak.megabytes()
    cost = {"seconds": seconds, "all_seconds": time.perf_counter() - began, "memory": memory}
    return Outcome(row, cost, form, described, pairs)


def _computed(
    vertices: FloatArray, faces: IntArray, settings: Settings | None
) -> tuple[FloatArray, IntArray, IntArray | None, dict[str, Any], float]:
    """Compute a form and return vertices, triangles, patches, figures and seconds."""
    if settings is None:
        return vertices, faces, None, {"features": None, "pair_count": None, "warnings": 0, "unfinished": 0}, 0.0
    began = time.perf_counter()
    form = canonical_form(vertices, faces, settings)
    seconds = time.perf_counter() - began
    if method_named(settings.method).pairs in ("all", "landmarks"):  # a rival: it does without feature points
        seconds -= sum(form.timings.get(stage, 0.0) for stage in DETECTION)
    row = {
        "features": len(form.feature_points),
        "pair_count": form.pair_count,
        "warnings": len(form.warnings),
        "unfinished": int(any(told.kind == "still_falling" for told in form.warnings)),
    }
    return form.vertices, form.faces, form.patches, row, seconds


def _plain(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


def hausdorff_row(forms: list[FloatArray]) -> tuple[list[float], float]:
    """Return the distances of the first of several shapes from the others, after rigid alignment, with mirror images.

    Parameters
    ----------
    forms : list of (n, 3) ndarray of float
        Shapes, in units of sqrt(area) of their poses.

    Returns
    -------
    distances : list of float
        Hausdorff distances of the second, third … from the first, in units of sqrt(area).
    seconds : float
        Computation time.
    """
    began = time.perf_counter()
    with one_thread():
        distances = [hausdorff(forms[0], other, mirror=True) for other in forms[1:]]
    return distances, time.perf_counter() - began


def one_thread() -> Any:
    """Limit linear algebra to one thread: workers do not slow each other down, and results are reproducible bit by bit.

    Returns
    -------
    context manager
        Active while entered; does nothing without threadpoolctl, where the environment must limit the threads.
    """
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return nullcontext()
    return threadpool_limits(1)


class _Peak:
    """Peak memory of this process since the object was created, minus its memory then; Linux only."""

    def __init__(self) -> None:
        self._before = None
        if sys.platform == "linux":
            try:
                Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # reset the peak
            except OSError:
                return
            self._before = _kilobytes_on_linux("VmRSS")

    def megabytes(self) -> float | None:
        if self._before is None:
            return None
        return max(_kilobytes_on_linux("VmHWM") - self._before, 0) / 1e3


def _kilobytes_on_linux(name: str) -> int:
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith(name + ":")))
