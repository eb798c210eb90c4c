"""The result on a new object whose mesh is cut and capped where skin was parted."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import bpy
import numpy as np

from ..mesh_items.palette import colours_of
from ..objects.marked_contacts import KEEP_GROUP, PART_GROUP
from ..objects.mesh_reading import Reading, read_mesh
from ..records.form_report import patch_sizes
from ..results.match_values import MatchValues
from ..words.advice import CUT
from ..words.wording import told
from .form_result import FormResult

if TYPE_CHECKING:
    from ...core import CanonicalForm, PosedLike
    from ...core.numerics.arrays import FloatArray

    Turned = TypeVar("Turned", CanonicalForm, PosedLike)


def turned(found: Turned, turn: FloatArray) -> Turned:
    """Turn a form or a pose, and that of the parted mesh with it.

    Parameters
    ----------
    found : CanonicalForm or PosedLike
        The result.
    turn : (3, 3) ndarray of float
        The rotation, for row vectors.

    Returns
    -------
    CanonicalForm or PosedLike
        The turned result.
    """
    parted = None if found.parted is None else found.parted.turned(turn)
    return replace(found, vertices=found.vertices @ turn, parted=parted)


def on_parted_object(target: bpy.types.Object, reading: Reading, result: FormResult) -> FormResult:
    """Cut and cap a new object where its mesh was parted for a result.

    Parameters
    ----------
    target : bpy.types.Object
        The object, with a mesh of its own, as it was read, without shape keys.
    reading : Reading
        The object whose copy it is.
    result : FormResult
        Its result.

    Returns
    -------
    FormResult
        The result on the object as it is now. Nothing changes if the mesh was not parted, is one object of several, or
        has mirror images.
    """
    from ...core import CanonicalForm, PosedLike
    from ..results.parted_objects import part_object

    whole = result.found
    if not isinstance(whole, CanonicalForm | PosedLike) or whole.parted is None:
        return result
    parted = whole.parted
    if len(parted.representative) != len(reading.vertices):
        stretched = told("Skin was parted, and is stretched here: only a single object without a mirror is cut.")
        if stretched not in result.report.warnings:
            result.report.warnings.append(stretched)
        return result
    rows, given = part_object(target, parted, whole.faces)
    for name in (PART_GROUP, KEEP_GROUP):  # what they mark is done
        if name in target.vertex_groups:
            target.vertex_groups.remove(target.vertex_groups[name])
    vertices, faces = read_mesh(target.data)
    own, held = parted.result, rows >= 0
    number = np.zeros(len(parted.mesh.vertices), dtype=np.int64)
    number[rows[held][::-1]] = np.flatnonzero(held)[::-1]  # the first of several copies
    vertices[held] = own.vertices[rows[held]]
    patches, adf = np.where(held, own.patches[rows], -1), np.where(held, own.adf[rows], 0.0)
    cap = held & (parted.mesh.origin[rows] < 0)
    contacts, points = whole.contacts[given] | cap, number[own.feature_points]
    found = replace(
        whole,
        vertices=vertices,
        faces=faces,
        feature_points=points,
        patches=patches,
        adf=adf,
        contacts=contacts,
        parted=None,
    )
    report = replace(
        result.report,
        vertices=len(vertices),
        faces=len(faces),
        feature_points=points.tolist(),
        mends={said: mend for said, mend in result.report.mends.items() if mend != CUT},
        patch_sizes=patch_sizes(patches, len(points)),
    )
    carried = None if result.carried is None else MatchValues(*(each[given] for each in result.carried))
    return FormResult(found, report, colours_of(adf, patches, faces), [], carried)
