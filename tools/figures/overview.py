"""Figure 4: one model from its pose to its form, with the number of distances used."""

import numpy as np
from matplotlib.figure import Figure

from addon.core import Settings, canonical_form
from tools.figures.drawing import show
from tools.figures.models import facing


def draw(models):
    name = "man" if "man" in models else next(iter(models))
    _, vertices, faces = models[name][-1] if name != "man" else next(p for p in models["man"] if p[0] == "walk1_04")
    turn = facing(name)
    form = canonical_form(vertices, faces, Settings(method="local_features"))
    whole = Settings(method="local_features", quality="full", max_iterations=1)
    full = canonical_form(vertices, faces, whole) if len(vertices) < 6000 else None
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    grid = figure.subplots(1, 4)
    pairs = f"{form.pair_count / 1e6:.2f} million distances,\n{form.pair_reduction:.1%} less than all pairs"
    show(grid[0], vertices, faces, turn, title="pose", under=f"{len(vertices):,} vertices")
    show(grid[1], vertices, faces, turn, np.log(form.adf), points=form.feature_points,
         title="Auto Diffusion Function", under=f"{len(form.feature_points)} feature points")  # fmt: skip
    show(grid[2], vertices, faces, turn, patches=form.patches, title="patches", under=pairs)
    show(grid[3], form.vertices, faces, None if name == "man" else turn, patches=form.patches, title="canonical form",
         under=f"stress {form.stress[0]:.3g} to {form.stress[-1]:.3g}\nin {len(form.stress) - 1} steps")  # fmt: skip
    figures = {"pair_count": form.pair_count, "pair_reduction": form.pair_reduction}
    if full is not None:
        figures["pair_reduction_full"] = full.pair_reduction
    return figure, figures
