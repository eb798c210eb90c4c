"""What each step and constant of the default buys: ``ablation.py FOLDER``, a folder of posed meshes by body.

Every row takes one step out, or changes one constant, over all bodies: pose ratio, edges, compactness error and
seconds, as a ratio or a difference to the default. The rows of jitter, landmarks 90 and 110 and vertices rounded to
single precision, tell what is noise: a step stays if it buys more than two deviations of it, off the line that the
rows of *Preserve Detail* draw.
"""

import argparse
import sys
from contextlib import ExitStack
from pathlib import Path
from time import process_time
from unittest import mock

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import Settings, canonical_form  # noqa: E402
from addon.core.deformation import elastic_body  # noqa: E402
from addon.core.embedding import layout  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.measures.form_measures import compactness_error, edge_stretch  # noqa: E402
from addon.core.mesh.edges import is_closed  # noqa: E402
from addon.core.mesh.geometry import surface_area, vertex_areas  # noqa: E402
from addon.core.methods import straight  # noqa: E402
from tests.meshes.shapes import read_obj  # noqa: E402

NO_STRUTS = np.empty((0, 2), dtype=np.int64)
JITTER = ("landmarks 90", "landmarks 110", "single precision")
# name: (settings, what is put in the place of names of modules)
VARIANTS: dict[str, tuple[dict, list[tuple[object, str, object]]]] = {
    "landmarks 90": ({"landmark_count": 90}, []),
    "landmarks 110": ({"landmark_count": 110}, []),
    "single precision": ({}, []),
    "preserve .45": ({"preserve_detail": 0.45}, []),
    "preserve .55": ({"preserve_detail": 0.55}, []),
    "no struts": ({}, [(straight, "struts_through", lambda *_: NO_STRUTS)]),
    "layout: volume alone": ({}, [(layout, "_SURE", np.inf)]),
    "layout not made round": ({}, [(straight, "rounded", lambda body, layout, monitor: layout)]),
    "no push": ({}, [(straight, "_PUSH", 1e-9)]),
    "push 25": ({}, [(straight, "_PUSH", 25.0)]),
    "push 60": ({}, [(straight, "_PUSH", 60.0)]),
    "push: 50 steps": ({}, [(straight, "_PUSH_STEPS", 50)]),
    "no pairs across edges": ({}, [(straight, "_ACROSS", 1e-9)]),
    "no push at the ends": ({}, [(straight, "_ENDS_SHARE", 0.0)]),
    "lengths not undone": ({}, [(elastic_body.ElasticBody, "without_stretch", lambda body, form, share: form)]),
    "lengths averaged over .15": ({}, [(straight, "_LIMB", 0.15)]),
    "no rolls": ({}, [(straight, "limbs_rolled", lambda body, form, *_: form)]),
    "left not like right": ({"symmetry": "ignore"}, []),
    "edges want lengths alone": ({}, [(straight, "_BENDING", 0.0)]),
    "edges want vectors alone": ({}, [(straight, "_BENDING", 4.0)]),
    "no pressure": ({}, [(elastic_body.ElasticBody, "_inflated", lambda body, points, solve: points)]),
    "not mended": ({}, [(straight, "mended", lambda body, shape, monitor: shape)]),
    "first rotations not wide": ({}, [(elastic_body, "_WIDE", 1e-6)]),
}


def measured(poses, faces, name="", about=({}, [])):
    """Return pose ratio, edges (median, 95 %, 99.9 %), compactness error (10⁻⁴) and seconds of a body."""
    options, patches = about
    areas = vertex_areas(poses[0], faces)
    forms, edges, errors = [], [], []
    with ExitStack() as stack:
        for owner, attribute, value in patches:
            stack.enter_context(mock.patch.object(owner, attribute, value))
        began = process_time()
        for vertices in poses:
            given = vertices.astype(np.float32) if name == "single precision" else vertices
            form = canonical_form(given, faces, Settings(**options)).vertices
            edges.append(np.quantile(np.abs(edge_stretch(vertices, form, faces) - 1), (0.5, 0.95, 0.999)))
            errors.append(1e4 * compactness_error(vertices, form, faces) if is_closed(faces) else 0.0)
            forms.append(form)
    seconds = (process_time() - began) / len(poses)
    ratio = apart(forms, faces, areas) / apart(poses, faces, areas)
    return np.array([ratio, *np.mean(edges, axis=0), np.mean(errors), seconds])


def apart(shapes, faces, areas):
    """Return the mean distance of shapes of one body, rigidly aligned in pairs, in sqrt(area)."""
    shapes = [each / np.sqrt(surface_area(each, faces)) for each in shapes]
    found = []
    for number, one in enumerate(shapes):
        for other in shapes[:number]:
            turn, shift = rigid_fit(one, other, areas)
            found.append(np.sqrt(areas @ ((one @ turn + shift - other) ** 2).sum(axis=1) / areas.sum()))
    return float(np.mean(found))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--poses", type=int, default=4, help="of each body")
    parser.add_argument("--only", nargs="*", help="names of rows")
    options = parser.parse_args()
    bodies = {}
    for folder in sorted(path for path in options.data.iterdir() if any(path.glob("*.obj"))):
        meshes = [read_obj(path) for path in sorted(folder.glob("*.obj"))[: options.poses]]
        bodies[folder.name] = ([vertices for vertices, _ in meshes], meshes[0][1])
    base = {name: measured(*body) for name, body in bodies.items()}
    mean = np.mean(list(base.values()), axis=0)
    print(
        f"Bodies: {', '.join(bodies)}. Default: ratio {mean[0]:.3f}, edges {mean[1]:.4f}, {mean[2]:.3f}, {mean[3]:.2f},"
    )
    print(f"compactness error {mean[4]:.3f}, {mean[5]:.2f} s.\n")
    print("| | ratio | edges, median | 95 % | 99.9 % | compactness error | time |\n" + "| --- " * 7 + "|")
    for name, about in VARIANTS.items():
        if options.only and name not in options.only:
            continue
        found = {body: measured(*bodies[body], name, about) for body in bodies}
        ratio = np.exp(np.mean([np.log(found[body][0] / base[body][0]) for body in bodies]))
        change = np.mean([found[body] - base[body] for body in bodies], axis=0)
        time = sum(each[5] for each in found.values()) / sum(each[5] for each in base.values())
        print(
            f"| {name} | ×{ratio:.3f} | {change[1]:+.4f} | {change[2]:+.4f} | {change[3]:+.3f} | {change[4]:+.3f} |"
            f" ×{time:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
