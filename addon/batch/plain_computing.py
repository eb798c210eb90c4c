"""The form of one file without Blender: read as arrays, computed, written, told in a line."""

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
        What is to be done.
    reference : CanonicalForm or Likeness, optional
        What the form is laid onto; or the pose that is taken instead of a form.

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
    except Exception as error:  # any: the files after it are still to be computed
        yield failure(line, error)


def reference_plainly(path: Path, wanted: Wanted) -> CanonicalForm:
    """Compute the form of a file's mesh for others to be laid onto.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What is to be done with the others.

    Returns
    -------
    CanonicalForm
        Its form.

    Raises
    ------
    CanonicalFormError
        If it cannot be read or computed.
    """
    vertices, polygons = read_plain(path)
    return canonical_form(vertices, fans(polygons), wanted.settings)


def _require_plain(wanted: Wanted) -> None:
    """Refuse what only Blender does."""
    if wanted.shown:
        raise CanonicalFormError(f"--mesh shown, --frame and --frames: this {_NEEDS_BLENDER}.")
    if f".{wanted.format}" not in PLAIN:
        raise CanonicalFormError(
            f"--format {wanted.format} {_NEEDS_BLENDER}. Without it, choose {', '.join(kind[1:] for kind in PLAIN)}."
        )


def _figures(vertices: np.ndarray, form: CanonicalForm | PosedLike, wanted: Wanted) -> Line:
    """Tell of a form or a pose what the report in Blender tells."""
    sizes = np.bincount(form.patches[form.patches >= 0], minlength=len(form.feature_points))
    measures = summary(vertices, form.vertices, form.faces, True)
    own: Line = {}
    if isinstance(form, CanonicalForm):
        own = {
            "method": wanted.settings.method,
            "stress": {"first": float(form.stress[0]), "last": float(form.stress[-1]), "steps": len(form.stress) - 1},
            "pair_count": form.pair_count,
            "pair_reduction": form.pair_reduction,
        }
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
