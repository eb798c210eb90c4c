"""Copies of objects for export: shaped as their results, with everything of the user's and nothing of ours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..mesh_items.key_removal import remove_all_keys
from .result_clearing import clear_results

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray

_OURS = "canonical_form"  # begins the names of our custom properties


def drop_own_properties(owner: bpy.types.ID) -> None:
    """Remove our custom properties from a mesh or its keys.

    Parameters
    ----------
    owner : bpy.types.ID
        What has them.
    """
    for name in list(owner.keys()):
        if name.startswith(_OURS):
            del owner[name]


@contextmanager
def bare_copies(objects: Sequence[bpy.types.Object], shapes: Sequence[FloatArray]) -> Iterator[list[bpy.types.Object]]:
    """Copy objects, for a while, without their results, modifiers, shape keys, parents and animation.

    The copies have the names of the objects, which Blender would number, and their custom properties.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, in Object Mode.
    shapes : sequence of (n, 3) ndarray of float
        Positions of the vertices of each copy, in local space.

    Yields
    ------
    list of bpy.types.Object
        The copies, in the scene; they are removed at the end.
    """
    originals = [each for obj in objects for each in (obj, obj.data)]
    names = [each.name for each in originals]
    copies: list[bpy.types.Object] = []
    try:
        for each in originals:
            each.name = "Original"
        for obj, shape, name, mesh_name in zip(objects, shapes, names[::2], names[1::2], strict=True):
            copies.append(_bare_copy(obj, shape, name, mesh_name))
        yield copies
    finally:
        bpy.data.batch_remove([*copies, *(each.data for each in copies)])
        for each, name in zip(originals, names, strict=True):
            each.name = name


def _bare_copy(obj: bpy.types.Object, shape: FloatArray, name: str, mesh_name: str) -> bpy.types.Object:
    """Copy one object into the scene."""
    mesh = obj.data.copy()
    mesh.name = mesh_name
    copy = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(copy)
    if mesh.shape_keys is not None:
        remove_all_keys(copy)
    clear_results(copy, unconfirmed=True)
    drop_own_properties(mesh)
    for key, value in obj.items():
        if not key.startswith(_OURS):
            copy[key] = value
    mesh.vertices.foreach_set("co", shape.astype(np.float32).ravel())
    mesh.update()
    copy.matrix_world = obj.matrix_world
    if not np.allclose(copy.matrix_basis, obj.matrix_world, atol=1e-6):  # sheared, as no file format holds it
        mesh.transform(copy.matrix_basis.inverted_safe() @ obj.matrix_world)
    for own, slot in zip(copy.material_slots, obj.material_slots, strict=False):
        own.material = slot.material
    return copy
