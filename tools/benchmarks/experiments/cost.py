"""What a form costs: seconds by stage and peak memory, each measured in a process of its own; Linux only."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from addon.core import Settings, canonical_form
from addon.core.method_api.costs import memory_estimate
from tests.meshes import shapes
from tests.meshes.families import torus
from tests.meshes.remeshing import noisy, resized
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import in_own_process, timed, with_peak
from tools.benchmarks.mesh_sets import Body, finest, folders, generated

SIZES = (10_000, 40_000, 160_000, 640_000, 1_000_000)
STAGES = {"Surface": "surface, s", "Coarse mesh": "coarse mesh, s", "Prolongation": "back to all, s",
          "Alignment": "back to all, s"}  # fmt: skip
REST = "on the coarse mesh, s"


def cost(vertices: np.ndarray, faces: np.ndarray, settings: Settings) -> Row:
    """Measure a mesh in a process that did not make it: the form would use the memory again that this took."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.npz"
        np.savez(path, vertices=vertices, faces=faces)
        return in_own_process(_cost, path, settings)


def _cost(path: Path, settings: Settings) -> Row:
    with np.load(path) as stored:
        mesh = stored["vertices"], stored["faces"]
    (form, seconds), before, peak = with_peak(timed, canonical_form, *mesh, settings)
    stages = dict.fromkeys([*STAGES.values(), REST], 0.0)
    for stage, taken in form.timings.items():
        stages[STAGES.get(stage, REST)] += taken
    estimate = memory_estimate(len(mesh[0]), settings)
    return stages | {
        "vertices": len(mesh[0]),
        "features": len(form.feature_points),
        "seconds": seconds,
        "GB": peak,
        "of the form, GB": peak - before,
        "estimate, GB": estimate,
        "estimate / peak": estimate / (peak - before),
        "pairs": form.pair_count,
        "pairs saved": form.pair_reduction,
    }


def growth(rows: list[Row]) -> str:
    """Return the exponent of time against the number of vertices."""
    n, seconds = np.array([(row["vertices"], row["seconds"]) for row in rows if row["vertices"] >= 39_000]).T
    return f"Exponent of time against n from 40,000: **{np.polyfit(np.log(n), np.log(seconds), 1)[0]:.2f}**."


@experiment("scale", finest, settings={f"{count}": count for count in SIZES}, note=growth, kind="forms")
def scale(body: Body, count: int) -> Iterator[Row]:
    """The finest body, resized: the first run of a new process, hence longer than under speed, by stage; peak
    memory, and how much of it the form takes beyond the mesh and the program.
    """
    vertices, faces = body.first
    yield cost(*noisy(*resized(shapes.unit(vertices, faces), faces, count), 0.0002), Settings())


def in_sizes(data: Path | None) -> list[Body]:
    """Return meshes of a thousand to a million vertices: generated ones, and the bodies of the data."""
    made = generated(
        joint=lambda: shapes.joint(80, 40, 25),
        figure=lambda: shapes.figure(24),
        torus=lambda: torus(400, 250),
        sphere=lambda: shapes.sphere(8),
        sheet=lambda: shapes.grid(1000, 1000),
    )
    return [*made(data), *folders(data)]


@experiment("memory", in_sizes, settings={"normal": Settings()})
def memory(body: Body, settings: Settings) -> Iterator[Row]:
    """Peak memory of a form beyond the mesh and the program, and the estimate by which a run is refused."""
    yield cost(*body.first, settings)


def with_all_pairs(data: Path | None) -> list[Body]:
    """Return bodies of the size at which all pairs inside the patches can be used."""
    return [*generated(figure=lambda: shapes.figure(52))(data), *folders(data)]


@experiment("full", with_all_pairs, settings={"full": Settings(method="local_features", quality="full")})
def full(body: Body, settings: Settings) -> Iterator[Row]:
    """*Local Features* at quality *Full*: pairs as the paper counts them, Σ p² over the patches and the feature
    points, how many fewer they are than n², time and peak memory. The paper: 17 million at n = 9,501, 80 % saved.
    """
    yield from memory(body, settings)
