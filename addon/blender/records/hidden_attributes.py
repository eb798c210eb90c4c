"""Attributes that Blender's interface does not list: the patch of every vertex, and the whole form."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ..mesh_items.fingerprints import fingerprint

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray, IntArray
    from .record import Record


class HiddenAttribute(NamedTuple):
    """A point attribute whose name starts with a dot, so that Blender does not list it; only we use its name.

    Attributes
    ----------
    name : str
        Name on the mesh.
    data_type : str
        Blender's type of the attribute.
    field : str
        Property of an element that holds its value.
    dtype : type
        Type of the numbers.
    width : int
        Numbers per value.
    """

    name: str
    data_type: str
    field: str
    dtype: type
    width: int

    def write(self, mesh: bpy.types.Mesh, record: Record, values: np.ndarray) -> None:
        """Write values to a mesh, replacing earlier ones, and add them to the record.

        Parameters
        ----------
        mesh : bpy.types.Mesh
            The mesh, with its objects in Object Mode.
        record : Record
            The record of the run.
        values : (n,) or (n, width) ndarray
            One value per vertex.
        """
        values = values.astype(self.dtype)
        if self.name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[self.name])
        attribute = mesh.attributes.new(name=self.name, type=self.data_type, domain="POINT")
        record.hidden[attribute.name] = None
        attribute.data.foreach_set(self.field, values.ravel())
        record.hidden[attribute.name] = fingerprint(values)

    def read(self, mesh: bpy.types.Mesh) -> np.ndarray | None:
        """Read the values of a mesh.

        Parameters
        ----------
        mesh : bpy.types.Mesh
            The mesh, with its objects in Object Mode.

        Returns
        -------
        (n * width,) ndarray or None
            The values; None if the attribute does not exist.
        """
        attribute = mesh.attributes.get(self.name)
        if attribute is None or attribute.data_type != self.data_type or len(attribute.data) != len(mesh.vertices):
            return None
        values: np.ndarray = np.empty(self.width * len(attribute.data), dtype=self.dtype)
        attribute.data.foreach_get(self.field, values)
        return values

    def is_changed(self, mesh: bpy.types.Mesh, record: Record) -> bool:
        """Return whether the values are no longer those of the run: the mesh has other vertices, or another order.

        Parameters
        ----------
        mesh : bpy.types.Mesh
            The mesh, with its objects in Object Mode.
        record : Record
            The record of the run.

        Returns
        -------
        bool
            True if they were there and have changed.
        """
        known, values = record.hidden.get(self.name), self.read(mesh)
        return known is not None and values is not None and fingerprint(values) != known


HIDDEN_PATCHES = HiddenAttribute(".canonical_form_patch", "INT", "value", np.int32, 1)
HIDDEN_CONTACTS = HiddenAttribute(".canonical_form_contact", "INT", "value", np.int32, 1)
HIDDEN_FORM = HiddenAttribute(".canonical_form", "FLOAT_VECTOR", "vector", np.float32, 3)


def patches_of(mesh: bpy.types.Mesh) -> IntArray | None:
    """Read the patch of every vertex, as the last run wrote it.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (n,) ndarray of int or None
        Patch indices from 0, -1 for no patch; None if they are unknown.
    """
    values = HIDDEN_PATCHES.read(mesh)
    return None if values is None else values.astype(np.int64)


def whole_form_of(mesh: bpy.types.Mesh) -> FloatArray | None:
    """Read the whole form of the last run; the shape key may hold the form of some limbs only.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (n, 3) ndarray of float or None
        Positions in the mesh's local space; None if they are unknown.
    """
    values = HIDDEN_FORM.read(mesh)
    return None if values is None else values.reshape(-1, 3).astype(np.float64)


def contacts_of(mesh: bpy.types.Mesh) -> IntArray:
    """Read at which vertices the last run has parted skin that had grown together.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (c,) ndarray of int
        Their indices; none if nothing was parted.
    """
    values = HIDDEN_CONTACTS.read(mesh)
    return np.flatnonzero(values if values is not None else ()).astype(np.int64)
