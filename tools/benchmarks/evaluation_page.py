"""Puts two evaluations into the tables of docs/evaluation.md: ``evaluation_page.py NATIVE COARSE``.

NATIVE: of the meshes as they are; COARSE: of their versions with 2,000 vertices, on which all pairs can be used.
"""

import csv
import sys
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
    """Median seconds of a method on meshes of about so many vertices."""
    found = [float(line["seconds"]) for line in lines_of(folder, "costs.csv")
             if line["method"] == method and round(int(line["vertices"]), -3) == vertices]  # fmt: skip
    return f"{np.median(found):.2f}" if found else ""


def memory(folder, method):
    found = [float(line["memory_megabytes"]) for line in lines_of(folder, "costs.csv")
             if line["method"] == method and line["memory_megabytes"]]  # fmt: skip
    return f"{max(found):,.0f}" if found else ""


def short(word, digits=3):
    return f"{float(word):.{digits}f}" if word else ""


def table(folder, columns):
    head = ["method", "compactness error", "dev.", "edges, median", "Hausdorff", "pose ratio", "mirrored",
            "error × pose", "NN", "1st tier", "2nd tier", "DCG", *columns, "MB"]  # fmt: skip
    rows = []
    for line in lines_of(folder, "methods.csv"):
        name = line["method"]
        error, pose = float(line["compactness_error_mean_e4"]), float(line["pose_ratio"])
        words = [name, short(str(error)), short(line["compactness_error_deviation_e4"])]
        words += [short(line[key]) for key in ("edge_distortion_median_mean", "hausdorff_within_classes", "pose_ratio",
                                               "pose_ratio_mirrored")]  # fmt: skip
        words += ["" if name == "input" else f"{error * pose:.3f}"]
        words += [short(line[key]) for key in ("nearest_neighbour", "first_tier", "second_tier", "discounted_gain")]
        words += [column(name) for column in columns.values()]
        words += [memory(folder, name) if name != "input" else ""]
        rows.append(words)
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows])


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
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def main(native, coarse):
    native, coarse = Path(native), Path(coarse)
    two = {"s, 2k": lambda name: "" if name == "input" else seconds(coarse, name, 2000)}
    more = {
        "s, 5k": lambda name: "" if name == "input" else seconds(native, name, 5000),
        "s, 13k": lambda name: "" if name == "input" else seconds(native, name, 13000),
    }
    text = PAGE.read_text()
    for mark, made in (
        ("native", table(native, {**two, **more})),
        ("coarse", table(coarse, two)),
        ("paper", paper_table(native, coarse)),
    ):
        before, rest = text.split(f"<!-- {mark} -->\n", 1)
        after = rest.split(f"<!-- end of {mark} -->", 1)[1]
        text = f"{before}<!-- {mark} -->\n\n{made}\n\n<!-- end of {mark} -->{after}"
    PAGE.write_text(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
