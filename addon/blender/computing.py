"""Runs the method on an object: mesh in, results out, the object's mode kept."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np

from ..core import CanonicalForm, CanonicalFormError, Settings, canonical_form
from ..core.measures import summary
from ..core.monitor import Cancelled, Progress
from .mesh_reading import read_mesh
from .result_writing import clear_results, write_results


def compute_on(
    obj: bpy.types.Object,
    settings: Settings,
    value: float = 1.0,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> tuple[CanonicalForm, dict[str, Any]]:
    """Compute the canonical form of an object's mesh and write it there.

    Nothing is written before everything is computed, so an error or a cancel leaves the mesh as it was.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`; in any mode.
    settings : Settings
        Options of the method.
    value : float
        Value of the shape key.
    progress, cancelled : callable, optional
        As in `canonical_form`.

    Returns
    -------
    form : CanonicalForm
        The form.
    report : dict
        Counts, stress, measures, timings and warnings, ready for JSON (nan as None).

    Raises
    ------
    CanonicalFormError
        If the mesh cannot be used, or the run was cancelled; the message says what to do.
    """
    with object_mode(obj):
        vertices, faces = read_mesh(obj.data)
        form = canonical_form(vertices, faces, settings, progress, cancelled)
        report = _report(vertices, faces, form)
        report["warnings"] += _stretched(obj)
        write_results(obj, form, faces, value, report)
    return form, report


def clear_from(obj: bpy.types.Object) -> list[str]:
    """Remove from an object's mesh what `compute_on` wrote, in any mode.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    list of str
        Names of results that were left in place because they have been changed since.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    with object_mode(obj):
        return clear_results(obj)


@contextmanager
def object_mode(obj: bpy.types.Object) -> Iterator[None]:
    """Be in Object Mode for a while and go back, whatever happens.

    Parameters
    ----------
    obj : bpy.types.Object
        The active object.

    Yields
    ------
    None
        Control, with the object in Object Mode.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    mode = obj.mode
    if mode != "OBJECT":
        try:
            bpy.ops.object.mode_set(mode="OBJECT")
        except RuntimeError as error:
            raise CanonicalFormError(
                f"{obj.name} cannot leave its mode. Switch to Object Mode and run again."
            ) from error
    try:
        yield
    finally:
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)


def _report(vertices: np.ndarray, faces: np.ndarray, form: CanonicalForm) -> dict[str, Any]:
    measures = summary(vertices, form.vertices, faces)
    return {
        "vertices": len(vertices),
        "faces": len(faces),
        "feature_points": form.feature_points.tolist(),
        "patch_sizes": np.bincount(form.patches, minlength=len(form.feature_points)).tolist(),
        "stress": {"first": float(form.stress[0]), "last": float(form.stress[-1]), "steps": len(form.stress) - 1},
        "pair_count": form.pair_count,
        "pair_reduction": form.pair_reduction,
        "measures": {name: None if np.isnan(number) else number for name, number in measures.items()},
        "timings": form.timings,
        "warnings": list(form.warnings),
    }


def _stretched(obj: bpy.types.Object) -> list[str]:
    scale = np.abs(np.array(obj.matrix_world.to_scale()))
    if scale.max() <= 1.001 * scale.min():
        return []
    return [
        "The object's scale is not uniform, and the form was computed on the mesh without it. Apply the scale "
        "(Ctrl+A > Scale) and run again for the form of what you see."
    ]
