"""How good and how fast the default form is: quality, speed, other triangles."""

import itertools
from collections.abc import Callable, Iterable, Iterator
from time import perf_counter

import numpy as np
from scipy.spatial import KDTree

from addon.core import Settings, canonical_form
from addon.core.distances.heat import FEWEST, HeatMethod
from addon.core.measures.alignment import closest_point_fit
from addon.core.measures.detail_kept import detail_measures
from addon.core.measures.form_measures import summary
from addon.core.surface.delaunay import intrinsic_delaunay, refined
from addon.core.surface.triangulation import triangulated
from tests.meshes.remeshing import adaptive, noisy, quad_dominant, resized, uniform
from tests.meshes.shapes import Mesh, unit
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import library_seconds, timed
from tools.benchmarks.mesh_sets import Body, apart, finest_first, folders, pose_ratio


def overall(rows: list[Row]) -> str:
    """Return the pose ratio of each method over all bodies with several poses."""
    told = []
    for method in dict.fromkeys(row["setting"] for row in rows):
        own = [row for row in rows if row["setting"] == method and row["pose ratio"] is not None]
        ratio = sum(row["pose ratio"] * row["poses apart"] for row in own) / sum(row["poses apart"] for row in own)
        told.append(f"{method} **{ratio:.3f}**")
    return f"Pose ratio overall, sum over sum: {', '.join(told)}."


@experiment(
    "quality",
    folders,
    settings={name: Settings(method=name) for name in ("straight", "local_features")},
    note=overall,
    first=True,
)
def quality(body: Body, settings: Settings) -> Iterator[Row]:
    """The form of every pose, by the default and by equation 10, repaired. *Pose ratio*: how far the forms are
    apart over how far the poses are, *mirrored*: with mirror images allowed; *geodesics change*: from pose to pose,
    which no method can remove. Means over the poses, compactness error in 10⁻⁴, *asymmetry*: distance of the form
    from its own mirror image. *time / potpourri3d*: over the factorisation and 100 sources of its heat method on
    the same mesh in the same run, median.
    """
    poses, faces = body.poses[1:]
    found, ratios, measures = [], [], []
    for pose in poses:
        library = library_seconds(pose, faces)
        form, seconds = timed(canonical_form, pose, faces, settings)
        found.append(form)
        ratios.append(seconds / library)
        measures.append(
            summary(pose, form.vertices, faces, with_hausdorff=False)
            | detail_measures(pose, form.vertices, faces, form.patches)
        )
    forms = [form.vertices for form in found]
    mean = {name: np.mean([each[name] for each in measures]) for name in measures[0]}
    yield {
        "poses": len(poses),
        "features": several(len(form.feature_points) for form in found),
        "pose ratio": pose_ratio(poses, forms, faces),
        "mirrored": pose_ratio(poses, forms, faces, mirror=True),
        "poses apart": apart(poses, faces),
        "geodesics change": geodesics_change(poses, faces),
        "compactness error": 1e4 * mean["compactness_error"],
        "worst": 1e4 * max(each["compactness_error"] for each in measures),
        "edges, median": mean["edge_distortion_median"],
        "edges, 95 %": mean["edge_distortion_95"],
        "edges, 99.9 %": mean["edge_distortion_999"],
        "areas, median": mean["area_distortion_median"],
        "areas, 95 %": mean["area_distortion_95"],
        "thickness, median": mean["thickness_median"],
        "thickness, 95 %": mean["thickness_95"],
        "jags at borders": mean["border_jags"],
        "crossings added, worst": max(each["crossings_added"] for each in measures),
        "asymmetry, worst": max((form.asymmetry for form in found if form.asymmetry >= 0), default=None),
        "time / potpourri3d": np.median(ratios),
    }


def several(counts: Iterable[int]) -> str:
    """Return the different counts in words."""
    return ", ".join(map(str, sorted(set(counts))))


def geodesics_change(poses: list[np.ndarray], faces: np.ndarray) -> float:
    """Return the mean relative change of geodesics between 60 vertices across poses, which no method can remove."""
    some = np.random.default_rng(3).choice(len(poses[0]), min(60, len(poses[0])), replace=False)
    surfaces = (intrinsic_delaunay(triangulated(unit(pose, faces), faces)) for pose in poses)
    tables = [HeatMethod(refined(each, FEWEST), count=len(poses[0])).distances(some)[some] for each in surfaces]
    tables = [(table + table.T)[np.triu_indices(len(some), 1)] / 2 for table in tables]
    changes = [2 * np.abs(one - two) / (one + two) for one, two in itertools.combinations(tables, 2)]
    return float(np.mean(changes)) if changes else float("nan")


@experiment(
    "speed",
    finest_first,
    most=1,
    settings={f"{count}, normal": (count, Settings(), 100) for count in (10_000, 40_000, 160_000)}
    | {"20000, draft": (20_000, Settings(quality="draft"), 25)},
    first=True,
)
def speed(body: Body, setting: tuple[int, Settings, int]) -> Iterator[Row]:
    """The finest body, resized: median of three runs in one process, and the same over the factorisation and some
    sources of potpourri3d's heat method. *In stages*: share of the time that the timings of a result tell;
    *longest wait* between two moments at which a run can be cancelled.
    """
    count, settings, sources = setting
    mesh = resized(*body.first, count)
    seconds, ratios = [], []
    for _ in range(3):
        library = library_seconds(*mesh, sources)
        form, taken = timed(canonical_form, *mesh, settings)
        seconds.append(taken)
        ratios.append(taken / library)
    asked = [perf_counter()]
    canonical_form(*mesh, settings, cancelled=lambda: bool(asked.append(perf_counter())))  # type: ignore[func-returns-value]
    yield {
        "vertices": len(mesh[0]),
        "quality": settings.quality,
        "sources": sources,
        "seconds": np.median(seconds),
        "time / potpourri3d": np.median(ratios),
        "in stages": sum(form.timings.values()) / taken,
        "longest wait, s": max(np.diff(asked)),
    }


@experiment(
    "tessellation",
    folders,
    settings={"uniform": uniform, "adaptive": adaptive, "quad-dominant": quad_dominant, "noise of 0.2 edges": noisy},
    first=True,
)
def tessellation(body: Body, change: Callable[..., Mesh]) -> Iterator[Row]:
    """The first pose of each body with other triangles: distance of its form from that of the mesh as it is, root
    mean square of nearest points.
    """
    vertices, faces = unit(*body.first), body.poses.faces
    form = canonical_form(vertices, faces)
    other, corners = change(vertices, faces)
    edges = np.linalg.norm(other[corners] - other[np.roll(corners, 1, axis=1)], axis=2)
    found = canonical_form(other, corners)
    yield {
        "vertices": len(other),
        "edges, longest / shortest": np.quantile(edges, 0.999) / np.quantile(edges, 0.001),
        "forms apart": nearest_apart(unit(found.vertices, corners), unit(form.vertices, faces)),
        "features": len(found.feature_points),
        "features before": len(form.feature_points),
    }


def nearest_apart(one: np.ndarray, two: np.ndarray) -> float:
    """Return the root mean square distance of the nearest points of two shapes, after a rigid fit."""
    turn, shift = closest_point_fit(one, two)
    one = one @ turn + shift
    return float(np.sqrt(((KDTree(two).query(one)[0] ** 2).mean() + (KDTree(one).query(two)[0] ** 2).mean()) / 2))
