"""All methods on all bodies, and matches: by the commands ``evaluate`` and ``evaluate-matches``."""

import csv
import subprocess
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np

from addon.core.mesh.coarsening import coarsened
from addon.evaluation.methods import DEFAULT, INPUT, KNOWN, chosen_methods
from tests.meshes.shapes import write_off
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.mesh_sets import Body, Collection, folders, largest_pieces, together
from tools.benchmarks.results import KEPT, ROOT, key_of

POSES, FEWER = 7, 4  # of a body, and where there are many methods
ON_ALL_PAIRS = ("as-published", "as-published-closed")  # of a patch: not at full resolution
PAPER = {  # mean compactness error (10⁻⁴) on SHREC'15, from the paper's Table 3
    "classical": 8.44, "fast": 6.60, "non-metric": 5.17, "one-form": 4.89, "least-squares": 4.77, "as-published": 3.32,
    "as-published-closed": 3.32, "euclidean-normalised": 2.97, "euclidean-random": 1.86, "skeleton": 0.71,
}  # fmt: skip
MEASURES = {  # column: what methods.csv calls it
    "pose ratio": "pose_ratio", "mirrored": "pose_ratio_mirrored", "Hausdorff": "hausdorff_within_classes",
    "NN": "nearest_neighbour", "1st tier": "first_tier", "2nd tier": "second_tier", "DCG": "discounted_gain",
    "compactness error": "compactness_error_mean_e4", "dev.": "compactness_error_deviation_e4",
    "edges, median": "edge_distortion_median_mean", "edges, 95 %": "edge_distortion_95_mean",
    "edges, 99.9 %": "edge_distortion_999_mean", "areas, median": "area_distortion_median_mean",
    "areas, 95 %": "area_distortion_95_mean", "thickness, median": "thickness_median_mean",
    "thickness, 95 %": "thickness_95_mean", "crossings added": "crossings_added_mean", "jags": "jags_mean",
    "jags at borders": "border_jags_mean", "scale": "scale_mean", "not converged": "not_converged",
}  # fmt: skip
CELLS = {"open": "as-published", "closed": "as-published-closed"}
OPEN_QUESTIONS = {  # what the paper leaves open, by option, with the ways to read it: the first is the default
    "start": ("classical", "input"), "pair_weight": ("squared", "plain"), "biharmonic_scale": ("own", "geodesic"),
}  # fmt: skip
OF_CLASSES = {  # column: what classes.csv calls it
    "error": "compactness_error_mean_e4", "dev.": "compactness_error_deviation_e4", "pose ratio": "pose_ratio",
    "mirrored": "pose_ratio_mirrored", "Hausdorff": "hausdorff_within_class", "edges": "edge_distortion_median_mean",
    "scale": "scale_mean", "not converged": "not_converged",
}  # fmt: skip
STEPS = 1000
EIGENPAIRS = (80, 40, 160, 320)  # the first is the default


def bodies_of(data: Path | None) -> list[Body]:
    """Return all bodies together: an evaluation compares them with each other."""
    return together([*folders(data), *largest_pieces(data)])


def evaluated(
    command: str, collection: Body, setting: str, vertices: int | None, *words: str, poses: int = POSES
) -> Path:
    """Run a command of the evaluation on a collection; return its folder of results, from which it can be resumed.

    With a number of `vertices`, every pose has the same ones of them, so that slow methods can use all pairs.
    """
    assert isinstance(collection, Collection)
    folder = KEPT / command / f"{setting}-{key_of(__name__, collection, f'{command} {setting}')}"
    for body in collection.bodies:
        names, shapes, faces = body.poses
        fewer = coarsened(shapes[0], faces, vertices) if vertices else None
        for name, pose in list(zip(names, shapes, strict=True))[:poses]:
            mesh = (pose[fewer.kept], fewer.faces) if fewer else (pose, faces)
            write_off(folder / "meshes" / body.name / f"{name}.off", *mesh)
    call = [sys.executable, "-m", "addon", command, str(folder / "meshes"), "--output", str(folder / "results"), *words]
    subprocess.run(call, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return folder / "results"


def lines_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@experiment("evaluation", bodies_of, settings={"": [name for name in DEFAULT if name not in ON_ALL_PAIRS]})
def methods(collection: Body, chosen: list[str]) -> Iterator[Row]:
    """The methods that work on meshes as they are, on all bodies, up to seven poses each, of rigged files the largest
    piece. Compactness error in 10⁻⁴, beside the paper's on SHREC'15, whose shapes are others; Hausdorff distances of
    four poses; retrieval by nearest neighbour, first and second tier and discounted gain; *scale*: median length of
    an edge over that in the pose.
    """
    yield from compared(collection, "as-they-are", None, chosen)


@experiment("coarse", bodies_of, settings={"": [name for name in KNOWN if name not in (INPUT, "ours-draft")]})
def methods_on_fewer_vertices(collection: Body, chosen: list[str]) -> Iterator[Row]:
    """The same with 2,000 vertices, for which all pairs can be used (-full), and the paper's stress as published."""
    yield from compared(collection, "coarse", 2000, chosen)


def compared(collection: Body, name: str, vertices: int | None, chosen: list[str]) -> Iterator[Row]:
    """Evaluate methods on a collection, and take the figures of each from its tables."""
    words = "--methods", ",".join(chosen), "--hausdorff", str(FEWER)
    folder = evaluated("evaluate", collection, name, vertices, *words)
    costs = lines_of(folder / "costs.csv")
    for line in lines_of(folder / "methods.csv"):
        own = [cost for cost in costs if cost["method"] == line["method"] and line["method"] != INPUT]
        spent = {column: [float(cost[name]) for cost in own if cost[name]]
                 for column, name in (("seconds", "seconds"), ("MB", "memory_megabytes"))}  # fmt: skip
        yield {
            "method": line["method"],
            "the paper's error": PAPER.get(line["method"].removesuffix("-full")),
            **{column: float(line[each]) if line[each] else None for column, each in MEASURES.items()},
            "seconds": np.median(spent["seconds"]) if own else None,
            "MB": max(spent["MB"], default=None),
        }


def readings() -> dict[str, dict[str, str]]:
    """Return every reading of the paper by its name for the command: all of 80 eigenpairs, and the first of others."""
    ways = [dict(zip(OPEN_QUESTIONS, each, strict=True)) for each in product(*OPEN_QUESTIONS.values())]
    ways = [each | {"eigenpairs": str(EIGENPAIRS[0])} for each in ways]
    ways += [ways[0] | {"eigenpairs": str(count)} for count in EIGENPAIRS[1:]]
    found = {}
    for cells, method in CELLS.items():
        for way in ways:
            settings = ",".join(f"{name}={value}" for name, value in way.items())
            found[f"{method}:max_iterations={STEPS},{settings}"] = {"cells": cells, **way}
    return found


@experiment("readings", lambda data: together(folders(data)), settings={"": 2000})
def every_reading(collection: Body, vertices: int) -> Iterator[Row]:
    """The paper's equation 10 in every reading, on the same 2,000 vertices of four poses of each body, up to 1,000
    steps. *error*: of the compactness in 10⁻⁴, mean and standard deviation; *Hausdorff*: mean between the forms of
    a body; *edges*: median change of their lengths; *scale*: median length of an edge over that in the pose.
    """
    ways = readings()
    folder = evaluated("evaluate", collection, "readings", vertices, "--methods", ",".join(ways), poses=FEWER)
    lines = lines_of(folder / "classes.csv")
    for word, way in ways.items():
        name = chosen_methods([word])[-1].name
        for line in (each for each in lines if each["method"] == name):
            yield {
                **{column.replace("_", " "): value for column, value in way.items()},
                "of": line["class"],
                **{column: float(line[each]) if line[each] else None for column, each in OF_CLASSES.items()},
            }


@experiment("matches", bodies_of, settings={"": "ours"})
def matches(collection: Body, methods: str) -> Iterator[Row]:
    """Every pose matched with every other, which is reduced to 70 % of its vertices and shuffled, five poses of a
    body. *error*: geodesic distance of the match from the truth in 1/100 sqrt(area), mean and most; *near*: share
    below .05; *flips*: pairs with a tenth of the vertices beyond .3; *pose*: distance of the transferred pose
    from the true one over that between the two, for those more than .1 apart; *edges*: median change of their
    lengths; *crossed*: pairs after which more triangles cross than in either pose.
    """
    folder = evaluated("evaluate-matches", collection, methods, None, "--methods", methods, "--across")
    lines = [one | two for one, two in zip(lines_of(folder / "matches.csv"), lines_of(folder / "matches-costs.csv"),
                                           strict=True)]  # fmt: skip
    for label in dict.fromkeys(line["pairs of"] for line in lines):
        own = [line for line in lines if line["pairs of"] == label]
        value = {name: np.array([float(line[name]) for line in own if line[name]])
                 for name in ("error", "nearer", "pose", "edges", "seconds")}  # fmt: skip
        through = [
            [float(line[name] or 0) for name in ("crossings", "crossings_before", "crossings_true")] for line in own
        ]
        yield {
            "pairs of": label,
            "pairs": len(own),
            "error": 100 * value["error"].mean(),
            "most": 100 * value["error"].max(),
            "near": value["nearer"].mean(),
            "flips": sum(line["flip"] == "True" for line in own),
            "pose": value["pose"].mean() if len(value["pose"]) else None,
            "pose, most": max(value["pose"], default=None),
            "edges": np.median(value["edges"]),
            "crossed": sum(after > max(before, true) for after, before, true in through),
            "seconds": np.median(value["seconds"]),
        }
