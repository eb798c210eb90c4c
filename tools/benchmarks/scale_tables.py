"""Time and memory of the form from ten thousand vertices to a million, by stage; one process per size.

`form_tables.py` writes the tables; ``scale_tables.py MESH FORM`` measures the mesh of one file and stores its form.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import Settings, canonical_form  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from addon.core.method_api.costs import memory_estimate  # noqa: E402
from tests.meshes.shapes import read_obj, unit  # noqa: E402
from tools.benchmarks.remeshing import noisy, resized  # noqa: E402

SIZES = (10_000, 40_000, 160_000, 640_000, 1_000_000)
STAGES = {
    ("Surface",): "finding the surface, repairing it",
    ("Coarse mesh",): "coarse mesh",
    (): "all that works on the coarse mesh",
    ("Prolongation", "Alignment"): "back to all vertices, laid onto the pose",
}


def nearest_apart(one, two):
    from scipy.spatial import KDTree

    from addon.core.measures.alignment import closest_point_fit

    turn, shift = closest_point_fit(one, two)
    one = one @ turn + shift
    there, back = KDTree(two).query(one)[0], KDTree(one).query(two)[0]
    return float(np.sqrt((there**2).mean() / 2 + (back**2).mean() / 2))


def one_size(source, keep):
    """Measure one mesh in a process that did not create it: the form would reuse the memory that this took."""
    with np.load(source) as stored:
        mesh = stored["vertices"], stored["faces"]
    Path("/proc/self/clear_refs").write_text("5")  # reset the peak
    before = gigabytes("VmRSS")
    began = time.perf_counter()
    form = canonical_form(*mesh)
    seconds = time.perf_counter() - began
    peak = gigabytes("VmHWM")
    np.savez(keep, form=form.vertices / np.sqrt(surface_area(form.vertices, mesh[1])))
    print(len(mesh[0]), seconds, before, peak, len(form.feature_points), memory_estimate(len(mesh[0]), Settings()))
    print(json.dumps(form.timings))


def gigabytes(name):
    """Read a figure about this process from Linux."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(name + ":"))
    return int(line.split()[1]) / 1e6


def scale_table(data, work):
    rows, points, stages = [], [], []
    vertices, faces = read_obj(data / "man" / "rest.obj")
    for count in SIZES:
        source, keep = work / f"mesh-{count}.npz", work / f"form-{count}.npz"
        mesh = noisy(*resized(unit(vertices, faces), faces, count), 0.0002)
        np.savez(source, vertices=mesh[0], faces=mesh[1])
        done = subprocess.run(
            [sys.executable, __file__, str(source), str(keep)], capture_output=True, text=True, check=True
        )
        figures, timings = done.stdout.splitlines()
        n, seconds, before, peak, features, estimate = (float(word) for word in figures.split())
        stages.append((n, json.loads(timings)))
        points.append((n, seconds))
        rows.append(
            f"| {n:,.0f} | {seconds:.2f} s | {peak:.2f} GB | {peak - before:.2f} GB | {estimate:.2f} GB | "
            f"{features:.0f} |"
        )
        print(rows[-1], flush=True)
    log = np.log(np.array(points)[1:])
    exponent = np.polyfit(log[:, 0], log[:, 1], 1)[0]
    small, large = (np.load(work / f"form-{count}.npz")["form"] for count in (10_000, 160_000))
    text = (
        f"\nExponent of time against n from 40,000: **{exponent:.2f}**. Each time is the first run of a new "
        "process, hence longer than under *Speed*. Distance between the forms at 160,000 and 10,000 vertices: "
        f"{nearest_apart(large[::8], small):.2%} of sqrt(area), RMS of nearest points."
    )
    print(text, flush=True)
    return "\n".join(
        [
            "| vertices | time | peak memory | of which the form | estimated | features |\n" + "| --- " * 6 + "|",
            *rows,
            text,
            stage_table(stages),
        ]
    )


def stage_table(stages):
    """Return the table of the time of each stage and its growth with the mesh."""
    head = "| stage | " + " | ".join(f"{n:,.0f}" for n, _ in stages) + " | exponent from 160,000 |\n"
    head += "| --- " * (len(stages) + 2) + "|"
    rows = []
    for names, label in STAGES.items():
        seconds = [sum(each for name, each in timings.items() if (name in names) == bool(names)
                       and (names or not any(name in other for other in STAGES))) for _, timings in stages]  # fmt: skip
        log = np.log([(n, second) for (n, _), second in zip(stages, seconds, strict=True) if n > 100_000])
        growth = f"{np.polyfit(log[:, 0], log[:, 1], 1)[0]:.2f}" if names else ""
        rows.append(f"| {label} | " + " | ".join(f"{second:.2f} s" for second in seconds) + f" | {growth} |")
    return "\n".join(["\nThe same runs by stage:\n", head, *rows])


if __name__ == "__main__":
    one_size(*sys.argv[1:])
