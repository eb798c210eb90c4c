"""Computes the form of one file without Blender: reads arrays, computes, writes, and returns a result line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..blender.files.kinds_of_files import PLAIN
from ..blender.jobs.likeness import Likeness
from ..core import CanonicalForm, CanonicalFormError, PosedLike, canonical_form
from ..core.measures.form_measures import summary
from ..core.method_api.costs import memory_estimate
from .arguments import Wanted
from .lines import Line, failure, stage_line
from .plain_files import fans, read_plain, write_plain
from .targets import Targets

_NEEDS_BLENDER = "needs Blender as a module (pip install bpy)"


def compute_plainly(
    targets: Targets, wanted: Wanted, reference: CanonicalForm | Likeness | None = None
) -> Iterator[Line]:
    """Compute the mesh of a file and write its form.

    Parameters
    ----------
    targets : Targets
        The file, and the name of its result.
    wanted : Wanted
        What to do with the file.
    reference : CanonicalForm or Likeness, optional
        The form to align to, or the pose that is applied instead of computing a form.

    Yields
    ------
    dict
        One line.
    """
    line: Line = {"input": str(targets.path), "object": targets.path.stem}
    target = targets.of_file()
    try:
        _require_plain(wanted)
        vertices, polygons = read_plain(targets.path)
        memory = memory_estimate(len(vertices), wanted.settings)
        with stage_line(f"{targets.path.name} (about {memory:.1f} GB)", wanted.stages) as progress:
            shape: CanonicalForm | PosedLike
            if isinstance(reference, Likeness):
                shape, _ = reference.posed(vertices, fans(polygons), wanted.settings, progress)
            else:
                shape = canonical_form(
                    vertices, fans(polygons), wanted.settings, reference=reference, progress=progress
                )
        targets.require_new(target)
        placed = shape.vertices if wanted.axes is None else shape.vertices @ wanted.axes
        write_plain(target, placed, polygons, wanted.mark)
        figures = _figures(vertices, shape, wanted)
        if isinstance(reference, Likeness) and isinstance(shape, PosedLike):
            figures["like"] = reference.report(shape)._asdict()
        yield {**line, "output": str(target), "memory_estimate": memory, **figures}
    except Exception as error:  # any error, as other files follow
        yield failure(line, error)


def reference_plainly(path: Path, wanted: Wanted) -> CanonicalForm:
    """Compute the form of a file's mesh as a reference for others.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What to do with the other files.

    Returns
    -------
    CanonicalForm
        Its form.

    Raises
    ------
    CanonicalFormError
        If the file cannot be read or the form cannot be computed.
    """
    vertices, polygons = read_plain(path)
    return canonical_form(vertices, fans(polygons), wanted.settings)


def _require_plain(wanted: Wanted) -> None:
    """Reject options that need Blender."""
    if wanted.shown:
        raise CanonicalFormError(f"--mesh shown, --frame and --frames: this {_NEEDS_BLENDER}.")
    if f".{wanted.format}" not in PLAIN:
        raise CanonicalFormError(
            f"--format {wanted.format} {_NEEDS_BLENDER}. Without it, choose {', '.join(kind[1:] for kind in PLAIN)}."
        )


def _figures(vertices: np.ndarray, form: CanonicalForm | PosedLike, wanted: Wanted) -> Line:
    """Return the same report for a form or a pose as in Blender."""
    sizes = np.bincount(form.patches[form.patches >= 0], minlength=len(form.feature_points))
    measures = summary(vertices, form.vertices, form.faces, True)
    own: Line = {}
    if isinstance(form, CanonicalForm):
        own = {"method": wanted.settings.method}
        if len(form.stress):
            stress = {"first": float(form.stress[0]), "last": float(form.stress[-1]), "steps": len(form.stress) - 1}
            own |= {"stress": stress, "pair_count": form.pair_count, "pair_reduction": form.pair_reduction}
    return {
        **own,
        "pieces": wanted.settings.pieces,
        "vertices": len(vertices),
        "faces": len(form.faces),
        "feature_points": form.feature_points.tolist(),
        "patch_sizes": sizes.tolist(),
        "measures": {name: None if np.isnan(value) else value for name, value in measures.items()},
        "timings": form.timings,
        "warnings": [str(each) for each in form.warnings],
    }
