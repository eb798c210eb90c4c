"""What a form costs: seconds by stage and peak memory, each measured in a process of its own; Linux only."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.meshes import shapes
from tests.meshes.families import torus
from tests.meshes.remeshing import noisy, resized
from tools.benchmarks import one_form
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.mesh_sets import Body, finest_first, folders, generated

SIZES = (10_000, 40_000, 160_000, 640_000, 1_000_000)
STAGES = {"Surface": "surface", "Coarse mesh": "coarse mesh", "Prolongation": "back to all vertices",
          "Alignment": "back to all vertices"}  # fmt: skip
MADE = generated(
    joint=lambda: shapes.joint(80, 40, 25),
    figure=lambda: shapes.figure(52),
    torus=lambda: torus(400, 250),
    sphere=lambda: shapes.sphere(8),
    sheet=lambda: shapes.grid(1000, 1000),
)


def cost(vertices: np.ndarray, faces: np.ndarray, settings: Row, columns: tuple[str, ...]) -> Row:
    """Measure the form of a mesh in a process of its own; return some columns, or the seconds by stage."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.npz"
        np.savez(path, vertices=vertices, faces=faces)
        words = [sys.executable, "-m", one_form.__name__, str(path), json.dumps(settings)]
        done = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True)
    row, timings = json.loads(done.stdout.splitlines()[-1])
    for stage, taken in timings.items():
        name = f"seconds, {STAGES.get(stage, 'on the coarse mesh')}"
        row[name] = row.get(name, 0.0) + taken
    return {name: value for name, value in row.items() if name.startswith(columns)}


def growth(rows: list[Row]) -> str:
    """Return the exponent of time against the number of vertices."""
    n, seconds = np.array([(row["vertices"], row["seconds"]) for row in rows if row["vertices"] >= 39_000]).T
    return f"Exponent of time against n from 40,000: **{np.polyfit(np.log(n), np.log(seconds), 1)[0]:.2f}**."


@experiment("scale", finest_first, most=1, settings={f"{count}": count for count in SIZES}, note=growth, first=True)
def scale(body: Body, count: int) -> Iterator[Row]:
    """The finest body, resized: the first run of a new process, hence longer than under speed, by stage; peak memory,
    and how much of it the form takes beyond the mesh and the program.
    """
    mesh = noisy(*resized(shapes.unit(*body.first), body.poses.faces, count), 0.0002)
    yield cost(*mesh, {}, ("vertices", "seconds", "GB", "of the form", "estimate", "features"))


@experiment("memory", lambda data: [*MADE(data), *folders(data)])
def memory(body: Body, _: None) -> Iterator[Row]:
    """Peak memory of a form beyond the mesh and the program, and the estimate by which a run is refused."""
    yield cost(*body.first, {}, ("vertices", "of the form", "estimate"))


@experiment("full", lambda data: [*MADE(data)[1:2], *folders(data)])
def full(body: Body, _: None) -> Iterator[Row]:
    """*Local Features* at quality *Full*: pairs as the paper counts them, Σ p² over the patches and the feature points,
    how many fewer they are than n², time and peak memory. The paper: 17 million at n = 9,501, 80 % saved.
    """
    settings = {"method": "local_features", "quality": "full"}
    yield cost(*body.first, settings, ("vertices", "features", "pairs", "seconds", "GB"))
