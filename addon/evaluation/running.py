"""Runs what is not done yet: forms and their measures first, then Hausdorff distances within classes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import cast

import numpy as np

from ..core import CanonicalFormError
from ..scheduling.attempts import Failure, give_memory_back
from ..scheduling.crews import Crew
from ..scheduling.workers import Work
from .dataset import Shape
from .methods import INPUT, KNOWN, Method
from .reading import Reader
from .store import Store, digest, keys_of
from .tables import evenly, scaled_form
from .work import Outcome, hausdorff_row, measured

Told = Callable[[str], object]
Lost = dict[tuple[Shape, Method], str]
Rows = dict[str, tuple[Method, list[Shape], str]]


def pending_forms(
    store: Store, shapes: Sequence[Shape], methods: Sequence[Method]
) -> tuple[dict[Shape, list[Method]], Lost]:
    """Return the missing results, and register the expected keys in the store.

    Parameters
    ----------
    store : Store
        The results so far.
    shapes : sequence of Shape
        The dataset.
    methods : sequence of Method
        The methods.

    Returns
    -------
    pending : dict of Shape to list of Method
        Methods to run on each shape.
    lost : dict of (Shape, Method) to str
        Reasons for shapes whose files cannot be opened.
    """
    pending: dict[Shape, list[Method]] = {}
    lost: Lost = {}
    for shape in shapes:
        try:
            keys = keys_of(shape.path, methods)
        except OSError as error:
            lost |= {(shape, each): f"{shape.path.name} cannot be read ({error.strerror})." for each in methods}
            continue
        missing = [each for each, key in zip(methods, keys, strict=True) if not store.expects(shape, each, key)]
        if missing:
            pending[shape] = missing
    return pending, lost


def compute_forms(store: Store, pending: dict[Shape, list[Method]], crew: Crew, told: Told, pace: list[float]) -> Lost:
    """Compute and store all missing forms.

    Parameters
    ----------
    store : Store
        Receives the results.
    pending : dict
        From `pending_forms`.
    crew : Crew
        The workers.
    told : callable
        Called with a name for each result.
    pace : list of float
        Receives the computation time of each result in seconds.

    Returns
    -------
    dict of (Shape, Method) to str
        Reasons for results that failed in this run: a mesh that cannot be read, a worker that died. Another run tries
        them again.

    Raises
    ------
    CanonicalFormError
        If the connection to the workers is lost.
    """
    lost: Lost = {}
    faces_of: dict[Shape, np.ndarray] = {}

    def work(reader: Reader) -> Iterator[tuple[object, Work]]:
        for shape, wanted in pending.items():
            try:
                vertices, faces = reader.triangles(shape.path)
            except (CanonicalFormError, OSError, MemoryError) as error:
                reason = " ".join(str(error).replace(str(shape.path), shape.path.name).split())
                for method in wanted:
                    lost[shape, method] = reason or type(error).__name__
                    told(f"{method.name} {shape.name}")
                continue
            for method in wanted:
                if method.name == INPUT:
                    faces_of[shape] = faces
                yield (shape, method), (measured, (vertices, faces, method))

    with closing(Reader()) as reader:
        for name, result in crew.results(work(reader)):
            shape, method = cast(tuple[Shape, Method], name)
            faces = faces_of.pop(shape, None) if method.name == INPUT else None
            if isinstance(result, Outcome):
                store.keep(shape, method, result, faces)
                pace.append(float(result.cost["all_seconds"] or 0.0))
                give_memory_back()
            else:
                lost[shape, method] = cast(Failure, result).reason
            told(f"{method.name} {shape.name}")
    return lost


def hausdorff_rows(store: Store, shapes: Sequence[Shape], methods: Sequence[Method], count: int) -> Rows:
    """Return the rows of the Hausdorff matrices: each shape of a class against those after it.

    Parameters
    ----------
    store : Store
        Contains the forms.
    shapes : sequence of Shape
        The dataset.
    methods : sequence of Method
        The methods.
    count : int
        Largest number of shapes per class; below 2 there are no matrices.

    Returns
    -------
    dict of str to (Method, list of Shape, str)
        By name of the row: the method, the shapes, and the key for the store.
    """
    rows: Rows = {}
    for method in methods:
        for label in sorted({shape.label for shape in shapes}):
            some = hausdorff_shapes(store, shapes, method, label, count)
            keys = [store.key(shape, method) for shape in some]
            for first in range(len(some) - 1):
                rows[row_name(method, label, first)] = (method, some[first:], digest(*keys[first:]))
    return rows


def hausdorff_shapes(store: Store, shapes: Sequence[Shape], method: Method, label: str, count: int) -> list[Shape]:
    """Choose the shapes of a class to be compared with each other.

    Parameters
    ----------
    store : Store
        Contains the forms.
    shapes : sequence of Shape
        The dataset.
    method : Method
        The method.
    label : str
        The class.
    count : int
        Largest number of shapes.

    Returns
    -------
    list of Shape
        Those with a form, evenly chosen.
    """
    done = []
    for shape in shapes:
        result = store.result(shape, method) if shape.label == label and count > 1 else None
        faces = store.result(shape, KNOWN[INPUT]) if result is not None else None
        if result is not None and faces is not None and "error" not in result["row"]:
            done.append(shape)
    return evenly(done, count) if done else []


def row_name(method: Method, label: str, first: int) -> str:
    """Return the name of a row of a Hausdorff matrix.

    Parameters
    ----------
    method : Method
        The method.
    label : str
        The class.
    first : int
        Index of the row.

    Returns
    -------
    str
        Its name in the store.
    """
    return f"hausdorff/{method.name}/{label}/{first}"


def compute_hausdorff(store: Store, rows: Rows, crew: Crew, told: Told, pace: list[float]) -> dict[str, str]:
    """Compute and store all missing rows of the Hausdorff matrices.

    Parameters
    ----------
    store : Store
        Contains the forms, and receives the rows.
    rows : dict
        The missing rows, from `hausdorff_rows`.
    crew : Crew
        The workers.
    told : callable
        Called with a name for each row.
    pace : list of float
        Receives the computation time of each row in seconds.

    Returns
    -------
    dict of str to str
        Reasons for missing rows, by name.

    Raises
    ------
    CanonicalFormError
        If the connection to the workers is lost.
    """
    lost: dict[str, str] = {}

    def work() -> Iterator[tuple[object, Work]]:
        for name, (method, some, _) in rows.items():
            yield name, (hausdorff_row, ([scaled_form(store, shape, method) for shape in some],))

    for name, result in crew.results(work()):
        if isinstance(result, Failure):
            lost[str(name)] = result.reason
        else:
            distances, seconds = result
            store.keep_comparison(str(name), rows[str(name)][2], {}, {"distances": np.array(distances)})
            pace.append(seconds)
        told(str(name))
    return lost
