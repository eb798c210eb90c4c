"""Inserts the tables of two evaluations into docs/evaluation.md: ``evaluation_page.py NATIVE COARSE [--page FILE]``.

NATIVE: evaluation of the original meshes; COARSE: of versions with 2,000 vertices, for which all pairs can be used.
"""

import argparse
import csv
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "evaluation.md"
PAPER = {  # mean compactness error on SHREC'15, from the paper's Table 3
    "classical": 8.44, "fast": 6.60, "non-metric": 5.17, "one-form": 4.89, "least-squares": 4.77,
    "as-published": 3.32, "as-published-closed": 3.32, "euclidean-normalised": 2.97, "euclidean-random": 1.86,
    "skeleton": 0.71,
}  # fmt: skip


def lines_of(folder, name):
    return list(csv.DictReader((folder / name).read_text().splitlines()))


def seconds(folder, method, vertices):
    """Return the median seconds of a method on meshes of about this number of vertices."""
    found = [float(line["seconds"]) for line in lines_of(folder, "costs.csv")
             if line["method"] == method and round(int(line["vertices"]), -3) == vertices]  # fmt: skip
    return f"{np.median(found):.2f}" if found else ""


def memory(folder, method):
    found = [float(line["memory_megabytes"]) for line in lines_of(folder, "costs.csv")
             if line["method"] == method and line["memory_megabytes"]]  # fmt: skip
    return f"{max(found):,.0f}" if found else ""


def short(word, digits=3):
    return f"{float(word):.{digits}f}" if word else ""


DETAIL = {  # column headings, and the measure whose mean over the meshes is shown, in %
    "edges, median": "edge_distortion_median_mean", "edges, 95 %": "edge_distortion_95_mean",
    "edges, 99.9 %": "edge_distortion_999_mean", "areas, median": "area_distortion_median_mean",
    "areas, 95 %": "area_distortion_95_mean", "thickness, median": "thickness_median_mean",
    "thickness, 95 %": "thickness_95_mean", "crossings added": "crossings_added_mean", "jags": "jags_mean",
    "jags at borders": "border_jags_mean",
}  # fmt: skip


def percent(word):
    """Format a share as a percentage, with two decimals if it is small and none if it is large."""
    if not word:
        return ""
    share = 100 * float(word)
    return f"{share:.2f}" if abs(share) < 10 else f"{share:.1f}" if abs(share) < 100 else f"{share:,.0f}"


def detail_table(folder):
    rows = [["method", *DETAIL], ["---"] * (1 + len(DETAIL))]
    for line in lines_of(folder, "methods.csv"):
        if line["method"] != "input":
            rows.append([line["method"], *(percent(line[key]) for key in DETAIL.values())])
    return joined(rows)


def table(folder, columns):
    head = ["method", "pose ratio", "mirrored", "Hausdorff", "NN", "1st tier", "2nd tier", "DCG", "compactness error",
            "dev.", *columns, "MB"]  # fmt: skip
    keys = ("pose_ratio", "pose_ratio_mirrored", "hausdorff_within_classes", "nearest_neighbour", "first_tier",
            "second_tier", "discounted_gain", "compactness_error_mean_e4",
            "compactness_error_deviation_e4")  # fmt: skip
    rows = [head, ["---"] * len(head)]
    for line in lines_of(folder, "methods.csv"):
        name = line["method"]
        costs = [*(column(name) for column in columns.values()), memory(folder, name)] if name != "input" else []
        rows.append([name, *(short(line[key]) for key in keys), *costs, *[""] * (1 + len(columns) - len(costs))])
    return joined(rows)


def joined(rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def paper_table(native, coarse):
    ours = {line["method"]: line["compactness_error_mean_e4"] for line in lines_of(native, "methods.csv")}
    few = {line["method"]: line["compactness_error_mean_e4"] for line in lines_of(coarse, "methods.csv")}
    rows = [
        ["method", "the paper, SHREC'15", "here, meshes as they are", "here, 2,000 vertices, all pairs"],
        ["---"] * 4,
    ]
    for name, figure in PAPER.items():
        rows.append(
            [name, f"{figure:.2f}", short(ours.get(name, ""), 2), short(few.get(f"{name}-full", few.get(name, "")), 2)]
        )
    return joined(rows)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("native", type=Path)
    parser.add_argument("coarse", type=Path)
    parser.add_argument("--page", type=Path, default=PAGE, help="where to write the page with its new tables")
    options = parser.parse_args()
    native, coarse = options.native, options.coarse
    two = {"s, 2k": lambda name: seconds(coarse, name, 2000)}
    more = {"s, 5k": lambda name: seconds(native, name, 5000), "s, 13k": lambda name: seconds(native, name, 13000)}
    text = PAGE.read_text(encoding="utf-8")
    for mark, made in (
        ("native detail", detail_table(native)),
        ("coarse detail", detail_table(coarse)),
        ("native", table(native, {**two, **more})),
        ("coarse", table(coarse, two)),
        ("paper", paper_table(native, coarse)),
    ):
        before, rest = text.split(f"<!-- {mark} -->\n", 1)
        after = rest.split(f"<!-- end of {mark} -->", 1)[1]
        text = f"{before}<!-- {mark} -->\n\n{made}\n\n<!-- end of {mark} -->{after}"
    options.page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
