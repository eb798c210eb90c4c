"""Seconds and processes: how the experiments time, and survive what they run."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable
from typing import Any

import numpy as np


def timed(function: Callable, *arguments: Any, **options: Any) -> tuple[Any, float]:
    """Return the result of a function, and its seconds."""
    began = time.perf_counter()
    return function(*arguments, **options), time.perf_counter() - began


def library_seconds(vertices: np.ndarray, faces: np.ndarray, sources: int = 100) -> float:
    """Return the seconds of potpourri3d's heat method: its factorisation, and a number of sources (by the mean of 20).

    The unit of times in the tables: seconds depend on the machine, and on what else it does.
    """
    import potpourri3d

    solver, factored = timed(potpourri3d.MeshHeatMethodDistanceSolver, vertices, faces)
    some = np.linspace(0, len(vertices) - 1, 20).astype(int)
    _, taken = timed(lambda: [solver.compute_distance(int(source)) for source in some])
    return factored + sources * taken / len(some)


class Lost(Exception):
    """A process ended without a result, or took too long."""


def in_own_process(function: Callable, *arguments: Any, patience: float | None = None) -> Any:
    """Return the result of a function of a module, called in a new process.

    Raises
    ------
    Lost
        If the process ends without a result, or takes more seconds than `patience`.
    """
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, function, arguments), daemon=True)
    process.start()
    there.close()
    try:
        if not here.poll(patience):
            raise Lost(f"timeout ({patience:.0f} s)")
        answer = here.recv()
    except EOFError:
        process.join()
        raise Lost(f"crash ({process.exitcode})") from None
    finally:
        process.kill()
        process.join()
    if isinstance(answer, Exception):
        raise answer
    return answer


def _answer(pipe: Any, function: Callable, arguments: tuple) -> None:
    try:
        pipe.send(function(*arguments))
    except Exception as error:  # raised again where the result is awaited
        pipe.send(error)
