"""Measures the default form on real meshes, with libraries for comparison, and writes the tables to the docs.

Run ``make bench DATA=folder`` on a folder with one subfolder per shape and one .obj per pose. Takes about a quarter of
an hour. Every time is given relative to that of a library on the same mesh in the same run.
"""

import argparse
import itertools
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import Settings, canonical_form  # noqa: E402
from addon.core.distances.heat import HeatMethod  # noqa: E402
from addon.core.measures.detail_kept import detail_measures  # noqa: E402
from addon.core.measures.form_measures import compactness_error, edge_stretch  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from addon.core.surface.triangulation import triangulated  # noqa: E402
from addon.evaluation.tables import mean_apart  # noqa: E402
from tests.meshes.shapes import Mesh, poses_of, unit  # noqa: E402
from tools.benchmarks.remeshing import adaptive, noisy, quad_dominant, resized, uniform  # noqa: E402
from tools.benchmarks.scale_tables import nearest_apart, scale_table  # noqa: E402


def shapes_of(data: Path) -> Iterator[tuple[str, list[Mesh]]]:
    """Read every pose of every shape, the rest pose first, scaled to unit area."""
    for folder in sorted(path for path in data.iterdir() if path.is_dir()):
        poses = [(unit(vertices, faces), faces) for _, vertices, faces in poses_of(folder)]
        if poses:
            yield folder.name, poses


def of(detail, name):
    """Return the mean of one measure over the poses."""
    return float(np.mean([each[name] for each in detail]))


def distance_change(meshes):
    """Return the mean relative change of geodesics between 60 vertices across poses, which no method can remove."""
    vertices, _ = meshes[0]
    some = np.random.default_rng(3).choice(len(vertices), 60, replace=False)
    tables = [HeatMethod(triangulated(*mesh)).distances(some)[some] for mesh in meshes]
    tables = [(table + table.T) / 2 for table in tables]
    off = ~np.eye(60, dtype=bool)
    return float(
        np.mean(
            [(np.abs(one - two)[off] / ((one + two) / 2)[off]).mean() for one, two in itertools.combinations(tables, 2)]
        )
    )


def quality_table(data, picture):
    rows, single = [], []
    inputs_sum, proper_sum, mirror_sum = 0.0, 0.0, 0.0
    gallery = []
    for shape, meshes in shapes_of(data):
        forms, errors, median, high, detail, lopsided, counts = [], [], [], [], [], [], []
        for vertices, faces in meshes:
            form = canonical_form(vertices, faces)
            forms.append(form.vertices)
            errors.append(1e4 * compactness_error(vertices, form.vertices, faces))
            stretch = np.abs(edge_stretch(vertices, form.vertices, faces) - 1)
            median.append(float(np.median(stretch)))
            high.append(float(np.quantile(stretch, 0.95)))
            detail.append(detail_measures(vertices, form.vertices, faces, form.patches))
            lopsided.append(form.asymmetry)
            counts.append(len(form.feature_points))
        given, proper, mirror = mean_apart([v for v, _ in meshes]), mean_apart(forms), mean_apart(forms, mirror=True)
        inputs_sum, proper_sum, mirror_sum = inputs_sum + given, proper_sum + proper, mirror_sum + mirror
        single += errors
        rows.append(
            f"| {shape} | {len(meshes)} | {min(counts)}-{max(counts)} | {np.mean(errors):.3f} | {max(errors):.3f} | "
            f"{np.mean(median):.1%} | {np.mean(high):.1%} | {of(detail, 'edge_distortion_999'):.0%} | "
            f"{of(detail, 'area_distortion_median'):.1%} | {of(detail, 'area_distortion_95'):.1%} | "
            f"{of(detail, 'thickness_median'):.1%} | {of(detail, 'thickness_95'):.1%} | "
            f"{of(detail, 'border_jags'):.2%} | {max(each['crossings_added'] for each in detail):.2%} | "
            f"{np.nanmax(lopsided):.3f} | {proper / given:.3f} | {mirror / given:.3f} | {distance_change(meshes):.1%} |"
        )
        print(rows[-1], flush=True)
        gallery.append((meshes, forms))
    np.savez(
        picture,
        **{
            f"{k}_{i}_{name}": array
            for k, (meshes, forms) in enumerate(gallery)
            for i, ((vertices, faces), form) in enumerate(zip(meshes, forms, strict=True))
            for name, array in (("v", vertices), ("f", faces), ("x", form))
        },
    )
    head = (
        "| shape | poses | features | compactness error (10⁻⁴), mean | worst | edge distortion, median | "
        "95th percentile | 99.9th | areas, median | 95th percentile | thickness, median | 95th percentile | "
        "jags at patch borders | crossings added, worst | asymmetry, worst | pose ratio | mirror images allowed | "
        "change of geodesics |\n" + "| --- " * 18 + "|"
    )
    total = (
        f"\nCompactness error overall: {np.mean(single):.3f}·10⁻⁴. Pose ratio overall, sum over sum: "
        f"**{proper_sum / inputs_sum:.3f}** with proper rotations, {mirror_sum / inputs_sum:.3f} with mirror images. "
        "Measures are defined in [evaluation](evaluation.md#what-is-measured). The compactness error is next to "
        "nothing by construction, since an even pressure restores it: all other columns tell what was kept. "
        "*asymmetry*: distance of the form from its own mirror image, root mean square in sqrt(area). *change of "
        "geodesics*: mean relative change from pose to pose."
    )
    print(total, flush=True)
    return "\n".join([head, *rows, total])


def library_seconds(vertices, faces):
    """Return the seconds that potpourri3d's heat method needs to factorise, and for one source (mean of 20)."""
    import potpourri3d

    began = time.perf_counter()
    solver = potpourri3d.MeshHeatMethodDistanceSolver(vertices, faces)
    factored = time.perf_counter() - began
    began = time.perf_counter()
    for source in range(20):
        solver.compute_distance(source * 7)
    return factored, (time.perf_counter() - began) / 20


def speed_table(data):
    vertices, faces = next(meshes for name, meshes in shapes_of(data) if name == "man")[0]
    rows = []
    for count, allowed in ((10_000, 4), (40_000, 1.5), (160_000, 0.7)):
        mesh = resized(vertices, faces, count)
        ratios, seconds, covered = [], [], []
        for _ in range(3):
            factored, single = library_seconds(*mesh)
            began = time.perf_counter()
            form = canonical_form(*mesh)
            seconds.append(time.perf_counter() - began)
            ratios.append(seconds[-1] / (factored + 100 * single))
            covered.append(sum(form.timings.values()) / seconds[-1])
        rows.append(
            f"| {len(mesh[0]):,} | {np.median(seconds):.2f} s | **{np.median(ratios):.2f}** | {allowed} | "
            f"{min(covered):.1%} | {longest_wait(*mesh):.2f} s |"
        )
        print(rows[-1], flush=True)
    head = (
        "| vertices | default form | relative to potpourri3d (factorisation + 100 sources) | target | covered by stage "
        "timings | longest cancel latency |\n| --- | --- | --- | --- | --- | --- |"
    )
    text = draft_line(*resized(vertices, faces, 20_000))
    return "\n".join([head, *rows, text, smacof_table(vertices, faces)])


def draft_line(vertices, faces):
    import potpourri3d

    times = []
    for _ in range(5):
        factored, single = library_seconds(vertices, faces)
        began = time.perf_counter()
        potpourri3d.compute_distance(vertices, faces, 0)
        alone = time.perf_counter() - began
        began = time.perf_counter()
        canonical_form(vertices, faces, Settings(quality="draft"))
        times.append((time.perf_counter() - began, 25 * single, factored + 25 * single, 25 * alone))
    draft, sources, with_factor, calls = np.median(times, axis=0)
    line = (
        "\nTimes are medians of repeated runs in one process. "
        f"Draft on {len(vertices):,} vertices: {draft:.2f} s; relative to 25 sources of potpourri3d: "
        f"{draft / sources:.2f} with a factorised solver, **{draft / with_factor:.2f}** including the factorisation, "
        f"{draft / calls:.2f} by 25 calls of `compute_distance`, each of which factorises again."
    )
    print(line, flush=True)
    return line


def smacof_table(vertices, faces):
    """Compare our minimisation, including factorisation, with scikit-learn's on 2,000 points of the same mesh."""
    from sklearn.manifold import smacof as library

    from addon.core.embedding.smacof import smacof

    rows = []
    for count in (10_000, 2_000):
        mesh = resized(vertices, faces, count)
        some = np.sort(np.random.default_rng(0).choice(len(mesh[0]), 2_000, replace=False))
        distances = HeatMethod(triangulated(*mesh)).distances(some)[some]
        distances = (distances + distances.T) / 2
        theirs, same, ours, wholes = [], [], [], []
        for _ in range(3):
            began = time.perf_counter()
            _, reached, steps = library(
                distances, init=mesh[0][some], n_init=1, eps=1e-6, max_iter=300, return_n_iter=True,
                normalized_stress=False,
            )  # fmt: skip
            theirs.append(time.perf_counter() - began)
            history = smacof(distances, mesh[0][some], tolerance=0.0, max_iterations=300)[1]
            needed = int(np.argmax(np.append(history, -1.0) <= reached))  # 301: not reached in 300 steps
            began = time.perf_counter()
            smacof(distances, mesh[0][some], tolerance=0.0, max_iterations=needed)
            same.append(time.perf_counter() - began)
            for _ in range(3):
                timings = canonical_form(*mesh).timings
                wholes.append(sum(timings.values()))
                ours.append(timings["Factorisation"] + timings["Embedding"])
        seconds, alike, alone, whole = (float(np.median(each)) for each in (theirs, same, ours, wholes))
        rows.append(
            f"| {count:,} | {seconds:.1f} s, {steps} steps | "
            f"{alike:.2f} s, {needed} steps: {seconds / alike:.1f} times | "
            f"{alone:.2f} s: **{seconds / alone:.0f} times** | {whole:.2f} s: {seconds / whole:.1f} times |"
        )
        print(rows[-1], flush=True)
    head = (
        "\nscikit-learn's `smacof` on 2,000 points of a mesh (all pairs; distances and start given; n_init=1, "
        "eps=1e-6, max_iter=300), and the speed-up of: our `smacof` on the same problem, to the same stress; the "
        "minimisation of that mesh's default form, including its factorisation (pairs inside the patches of 1,600 "
        "vertices, tolerance 1e-3); and the whole default form.\n\n"
        "| vertices of the mesh | scikit-learn | same problem | minimisation of the form | whole form |\n"
        + "| --- " * 5
        + "|"
    )
    return "\n".join([head, *rows])


def longest_wait(vertices, faces):
    asked = [time.perf_counter()]

    def never() -> bool:
        asked.append(time.perf_counter())
        return False

    canonical_form(vertices, faces, cancelled=never)
    return float(np.diff(asked).max())


def tessellation_table(data):
    rows = []
    for shape, meshes in shapes_of(data):
        if shape not in ("man", "horse"):
            continue
        vertices, faces = meshes[0]
        form = canonical_form(vertices, faces)
        for name, change in (("uniform", uniform), ("adaptive", adaptive), ("quad-dominant", quad_dominant),
                             ("noise of 0.2 edges", noisy)):  # fmt: skip
            mesh = change(vertices, faces)
            edges = np.linalg.norm(mesh[0][mesh[1]] - mesh[0][np.roll(mesh[1], 1, axis=1)], axis=2)
            other = canonical_form(*mesh)
            ours = other.vertices / np.sqrt(surface_area(other.vertices, mesh[1]))
            rows.append(
                f"| {shape} | {name} | {len(mesh[0]):,} | "
                f"1:{np.quantile(edges, 0.999) / np.quantile(edges, 0.001):.0f} | "
                f"{nearest_apart(ours, form.vertices):.2%} | "
                f"{len(other.feature_points)} of {len(form.feature_points)} |"
            )
            print(rows[-1], flush=True)
    head = (
        "| shape | remeshing | vertices | range of edge lengths | distance between forms (RMS of nearest points) | "
        "features |\n" + "| --- " * 6 + "|"
    )
    return "\n".join([head, *rows])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data", type=Path)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "benchmarks.md")
    parser.add_argument("--only", nargs="*")
    options = parser.parse_args()
    work = ROOT / "build" / "benchmarks"
    work.mkdir(parents=True, exist_ok=True)
    parts = {
        "Quality": lambda: quality_table(options.data, work / "gallery.npz"),
        "Speed": lambda: speed_table(options.data),
        "Scale": lambda: scale_table(options.data, work),
        "Tessellation": lambda: tessellation_table(options.data),
    }
    text = [
        "# Benchmarks\n",
        "Quality, speed and scale of the default form, written by `make bench DATA=folder`. Two cores; "
        "the times of a ratio are from one run. Other pages round these figures; everything else that was measured is "
        "in [measurements](measurements.md).\n",
    ]
    for title, part in parts.items():
        if not options.only or title in options.only:
            text += [f"## {title}\n", part(), ""]
    options.output.write_text("\n".join(text))


if __name__ == "__main__":
    main()
