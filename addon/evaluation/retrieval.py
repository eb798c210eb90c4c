"""Measures of retrieval from a matrix of distances between shapes (Shilane et al., 2004)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..core.numerics.arrays import FloatArray


@dataclass(frozen=True)
class Retrieval:
    """How well shapes retrieve others of their class; means over all queries, 0 to 1.

    Attributes
    ----------
    nearest_neighbour : float
        Share of the queries whose nearest shape is of their class.
    first_tier : float
        Share of the c others of the query's class among the c nearest shapes.
    second_tier : float
        Share of them among the 2 c nearest shapes.
    discounted_gain : float
        Discounted cumulative gain, relative to that of a perfect order.
    queries : int
        Number of queries: shapes with others in their class.
    first_tiers : dict of str to float
        The first tier of each class.
    """

    nearest_neighbour: float
    first_tier: float
    second_tier: float
    discounted_gain: float
    queries: int
    first_tiers: dict[str, float]


def retrieval(distances: FloatArray, classes: Sequence[str]) -> Retrieval:
    """Use every shape as a query for the others of its class.

    Parameters
    ----------
    distances : (n, n) ndarray of float
        Distances between the shapes; the query itself is excluded. Ties keep the order of the shapes.
    classes : sequence of str
        Class of each shape.

    Returns
    -------
    Retrieval
        The measures; NaN without a query.

    References
    ----------
    Shilane, Min, Kazhdan and Funkhouser, "The Princeton Shape Benchmark", 2004.
    """
    labels = np.asarray(classes)
    rows = []
    tiers: dict[str, list[float]] = {}
    for query in range(len(labels)):
        others = np.delete(np.arange(len(labels)), query)
        order = others[np.argsort(distances[query, others], kind="stable")]
        hit = labels[order] == labels[query]
        members = int(hit.sum())
        if not members:
            continue
        worth = 1 / np.log2(np.maximum(np.arange(1, len(order) + 1), 2))  # 1, 1, 1 / log2 3, …
        first = float(hit[:members].mean())
        tiers.setdefault(str(labels[query]), []).append(first)
        rows.append(
            [
                float(hit[0]),
                first,
                hit[: 2 * members].sum() / members,
                worth[hit].sum() / worth[:members].sum(),
            ]
        )
    nearest, tier, second, gain = np.mean(rows, axis=0).tolist() if rows else [float("nan")] * 4
    by_class = {label: float(np.mean(each)) for label, each in tiers.items()}
    return Retrieval(nearest, tier, second, gain, queries=len(rows), first_tiers=by_class)


def tier_lead(one: Retrieval, other: Retrieval) -> tuple[float, float]:
    """Return by how much the first tier of one method is above that of another, class by class.

    Parameters
    ----------
    one, other : Retrieval
        Results on the same classes.

    Returns
    -------
    lead, error : float
        Mean over the classes that both have, and its standard error; NaN where there are too few.
    """
    shared = [label for label in one.first_tiers if label in other.first_tiers]
    leads = np.array([one.first_tiers[label] - other.first_tiers[label] for label in shared])
    lead = float(leads.mean()) if len(leads) else float("nan")
    return lead, float(leads.std(ddof=1) / np.sqrt(len(leads))) if len(leads) > 1 else float("nan")


def precision_at_recall(distances: FloatArray, classes: Sequence[str], steps: int = 20) -> FloatArray:
    """Return the precision at evenly spaced recalls, averaged over all queries.

    Parameters
    ----------
    distances : (n, n) ndarray of float
        Distances between the shapes.
    classes : sequence of str
        Class of each shape.
    steps : int
        Number of recalls: 1 / steps, 2 / steps … 1.

    Returns
    -------
    (steps,) ndarray of float
        Precision: the best value at this or a higher recall.
    """
    labels = np.asarray(classes)
    curves = []
    for query in range(len(labels)):
        others = np.delete(np.arange(len(labels)), query)
        hit = labels[others[np.argsort(distances[query, others], kind="stable")]] == labels[query]
        rank = np.flatnonzero(hit) + 1
        if len(rank):
            precision = np.maximum.accumulate((np.arange(1, len(rank) + 1) / rank)[::-1])[::-1]
            wanted = np.ceil(np.arange(1, steps + 1) / steps * len(rank) - 1e-9).astype(int) - 1
            curves.append(precision[wanted])
    return np.mean(curves, axis=0) if curves else np.full(steps, np.nan)
