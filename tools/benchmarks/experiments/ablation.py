"""What each step and constant of the default buys.

A step stays if it buys more than two deviations of the jitter, off the line that the rows of *Preserve Detail* draw.
"""

from collections.abc import Iterator
from contextlib import ExitStack
from time import process_time
from typing import Any, NamedTuple
from unittest import mock

import numpy as np

from addon.core import Settings, canonical_form
from addon.core.measures.form_measures import compactness_error, edge_stretch
from addon.core.mesh.edges import is_closed
from addon.core.methods import straight
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.mesh_sets import Body, folders, pose_ratio

POSES = 4
MEASURES = ("edges, median", "edges, 95 %", "edges, 99.9 %", "compactness error")
NUMBERS = ("ratio", *MEASURES, "time")


class Variant(NamedTuple):
    """Settings, names in modules or classes and what takes their place, and how positions are rounded."""

    settings: dict[str, Any] = {}
    patches: dict[str, Any] = {}
    kind: type = np.float64


CORE = "addon.core."
STRAIGHT, LAYOUT, ELASTIC = f"{CORE}methods.straight.", f"{CORE}embedding.layout.", f"{CORE}deformation.elastic_body."

VARIANTS = {
    "default": Variant(),
    "jitter: landmarks 90": Variant({"landmark_count": 90}),
    "jitter: landmarks 110": Variant({"landmark_count": 110}),
    "jitter: single precision": Variant(kind=np.float32),
    "preserve .45": Variant({"preserve_detail": 0.45}),
    "preserve .55": Variant({"preserve_detail": 0.55}),
    "no struts": Variant(patches={f"{STRAIGHT}struts_through": lambda *_: np.empty((0, 2), dtype=np.int64)}),
    "layout: volume alone": Variant(patches={f"{LAYOUT}_SURE": np.inf}),
    "layout and lengths not made round": Variant(patches={f"{STRAIGHT}rounded": lambda body, shape, *_: shape}),
    "no push": Variant(patches={f"{STRAIGHT}_PUSH": 1e-9}),
    "push 25": Variant(patches={f"{STRAIGHT}_PUSH": 25.0}),
    "push 60": Variant(patches={f"{STRAIGHT}_PUSH": 60.0}),
    "push: 50 steps": Variant(patches={f"{STRAIGHT}_PUSH_STEPS": 50}),
    "no pairs across edges": Variant(patches={f"{STRAIGHT}_ACROSS": 1e-9}),
    "no push at the ends": Variant(patches={f"{STRAIGHT}_ENDS_SHARE": 0.0}),
    "lengths not undone": Variant(patches={f"{ELASTIC}ElasticBody.without_stretch": lambda body, form, share: form}),
    "lengths undone once": Variant(
        patches={f"{STRAIGHT}with_lengths": lambda body, shape, monitor: body.without_stretch(shape, straight._LIMB)}
    ),
    "lengths averaged over .05": Variant(patches={f"{STRAIGHT}_LIMB": 0.05}),
    "no rolls": Variant(patches={f"{STRAIGHT}limbs_rolled": lambda body, form, *_: form}),
    "left not like right": Variant({"symmetry": "ignore"}),
    "edges want lengths alone in the detail": Variant(patches={f"{STRAIGHT}_DETAIL_BENDING": 0.0}),
    "edges want vectors alone in the detail": Variant(patches={f"{STRAIGHT}_DETAIL_BENDING": 4.0}),
    "no pressure": Variant(patches={f"{ELASTIC}ElasticBody._inflated": lambda body, points, solve: points}),
    "not mended": Variant(patches={f"{STRAIGHT}mended": lambda body, shape, monitor: shape}),
    "first rotations not wide": Variant(patches={f"{ELASTIC}_WIDE": 1e-6}),
}


def against_default(rows: list[Row]) -> list[Row]:
    """Return a row for each variant: factors of ratio and time, and differences of the others, over all bodies."""
    base = {row["mesh"]: row for row in rows if row["setting"] == "default"}
    table = [{"step": "default"} | {name: float(np.mean([row[name] for row in base.values()])) for name in NUMBERS}]
    for step in dict.fromkeys(row["setting"] for row in rows if row["setting"] != "default"):
        pairs = [(row, base[row["mesh"]]) for row in rows if row["setting"] == step]
        changes = {name: float(np.mean([row[name] - old[name] for row, old in pairs])) for name in MEASURES}
        factors = {name: float(np.exp(np.mean([np.log(row[name] / old[name]) for row, old in pairs])))
                   for name in ("ratio", "time")}  # fmt: skip
        table.append({"step": step} | changes | factors)
    return table


@experiment("ablation", folders, settings=VARIANTS, table=against_default)
def measured(body: Body, variant: Variant) -> Iterator[Row]:
    """One step of the default left out, or one constant changed, over the first 4 poses of every body. The first
    row has the pose ratio, the edges, the compactness error (10⁻⁴) and the seconds of the default; all others a
    factor for ratio and time, and a difference for the rest. The rows of jitter tell what is noise.
    """
    poses, faces = body.some(POSES), body.poses.faces
    forms, seconds = [], 0.0
    with ExitStack() as stack:
        for name, value in variant.patches.items():
            stack.enter_context(mock.patch(name, value))
        for pose in poses:
            began = process_time()
            forms.append(canonical_form(pose.astype(variant.kind), faces, Settings(**variant.settings)).vertices)
            seconds += process_time() - began
    pairs = list(zip(poses, forms, strict=True))
    edges = [np.quantile(np.abs(edge_stretch(*pair, faces) - 1), (0.5, 0.95, 0.999)) for pair in pairs]
    error = np.mean([1e4 * compactness_error(*pair, faces) for pair in pairs]) if is_closed(faces) else 0.0
    yield {
        "ratio": pose_ratio(poses, forms, faces),
        **dict(zip(MEASURES, [*np.mean(edges, axis=0), error], strict=True)),
        "time": seconds / len(poses),
    }
