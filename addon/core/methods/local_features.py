"""Equation 10 with the repairs that measurement asked for: one stress of patches and of landmarks between them.

Closed cells, so that neighbouring patches share vertices and nothing tears; geodesics averaged over ways, so that a
bent joint hardly shortens them; commute times of all eigenpairs; a start from the surface alone; and landmarks between
the patches, since feature points alone have no say in the pose. docs/method.md has a reason and a figure for each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..distances.spectral import GreensFunction
from ..embedding.classical_scaling import placed_around
from ..embedding.layout import laid_out
from ..embedding.patch_pairs import landmark_pairs, patch_pairs, total_weights
from ..embedding.smacof import smacof
from ..measures.alignment import outside_out
from ..method_api.catalogue import Method
from ..method_api.method_result import MethodResult, warn_if_still_falling
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import patches_of
from ..run.memory import require_pair_memory
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation
from ..stress.pairs import AllPairs, Pairs, Term
from .straight import body_of, carried, detailed, landmarks_of, mended, rounded

_SMOOTHING = 0.1  # time over which geodesics inside patches are averaged: such hardly shorten where a joint bends
_BETWEEN = 10.0  # weight of the other landmarks on a landmark, over that of its patch
_STRUTS = 0.5  # weight of the struts of a vertex, over all its other weight
_PULL = 12.0  # of the detail at preserve 1/2: scaling leaves more wrinkles than the push, which the detail is to smooth
_TOLERANCE = 5e-5  # relative decrease of the stress in a step at which it stops: at 1e-3 rolled sheets stay bent


class _Inside(NamedTuple):
    """The pairs inside the patches, and struts through the body."""

    patches: list[AllPairs]
    struts: list[Term]
    pair_count: int


def local_feature_form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface by the stress of equation 10, and give it the detail of the input."""
    body = monitor.kept("body", [found], lambda: body_of(found, monitor))
    inside = monitor.kept("inside", [body, settings.memory_limit], lambda: _inside(found, body, settings, monitor))
    landmarks, distances = monitor.kept(
        "landmarks", [found, settings.landmark_count], lambda: landmarks_of(found, settings.landmark_count, monitor)
    )
    start = monitor.kept("start", [body, landmarks], lambda: _start(found, body, landmarks, distances, monitor))

    def embedded() -> tuple[FloatArray, FloatArray]:
        between = landmark_pairs(landmarks, start, inside.patches, _BETWEEN)
        with monitor.stage("Factorisation"):
            stress = Majorisation([*inside.patches, *inside.struts, between])  # [10]
        with monitor.stage("Embedding"):
            form, history = stress.lowered(start, settings.max_iterations, tolerance=_TOLERANCE, monitor=monitor)
            warn_if_still_falling(history, _TOLERANCE, settings.max_iterations, monitor)
        return outside_out(body, form), history

    form, history = monitor.kept("embedded", [inside, start, settings.max_iterations], embedded)
    shape = form
    if settings.preserve_detail > 0:
        with monitor.stage("Detail"):
            shape = mended(body, detailed(body, form, settings.preserve_detail, _PULL, monitor), monitor)
    pairs = inside.pair_count + len(landmarks) ** 2
    return MethodResult(carried(found, body, shape, monitor), history, pairs)


def _start(
    found: SurfaceFeatures, body: ElasticBody, landmarks: IntArray, distances: FloatArray, monitor: Monitor
) -> FloatArray:
    """Lay the surface out; by least squares, since in classical scaling every distance comes out too short."""
    with monitor.stage("Layout"):
        layout = laid_out(distances, landmarks, body.points, body.faces, found.limbs)
        between = (distances[landmarks] + distances[landmarks].T) / 2
        fitted, _ = smacof(between, layout.points[landmarks], tolerance=_TOLERANCE, monitor=monitor)
        points = placed_around(distances, landmarks, fitted, layout.points)
        return rounded(body, points, monitor)


def _inside(found: SurfaceFeatures, body: ElasticBody, settings: Settings, monitor: Monitor) -> _Inside:
    """Measure geodesics and commute times inside the patches, and give struts their share of the weights."""
    surface, count = found.surface, len(found.surface.points)
    patches = patches_of(found.cells, surface.faces, len(found.features))
    sizes = [len(patch.vertices) for patch in patches]
    require_pair_memory(count, sizes, limit=settings.memory_limit, whole=settings.whole)
    with monitor.stage("Distances"):
        green = GreensFunction(found.stiffness, found.mass)
        sets = patch_pairs(
            surface.points,
            patches,
            lambda vertices: green.commute_time_squared(vertices, monitor),  # c_ij², [8]
            _SMOOTHING or None,
            monitor,
        )
    struts: list[Term] = []
    if _SMOOTHING > 0 and not body.is_edge.all():
        ends, lengths = body.near.ends[~body.is_edge], body.length[~body.is_edge]
        share = _STRUTS * total_weights(sets, count) / np.maximum(np.bincount(ends.ravel(), minlength=count), 1)
        struts.append(Pairs(ends, share[ends].mean(axis=1), count).wanting_lengths(lengths))
    return _Inside(sets, struts, sum(size**2 for size in sizes))


METHODS = (
    Method(
        name="local_features",
        label="Local Features",
        help="The paper's stress of patches and feature points, repaired; keeps lengths, and more of the pose",
        source="the paper, equation 10, with repairs",
        unfold=local_feature_form,
        stages={
            "Struts": 1,
            "Distances": 17,
            "Landmarks": 4,
            "Layout": 3,
            "Factorisation": 4,
            "Embedding": 18,
            "Detail": 4,
            "Prolongation": 2,
        },
        uses=("landmark_count", "preserve_detail", "max_iterations"),
        pairs="patches",
        rank=11,
        area_kept=True,
    ),
)
