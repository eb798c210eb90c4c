"""Checks meshes from files for faces that refer to what does not exist."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ...core import InvalidMeshError


def require_whole_faces(objects: Sequence[bpy.types.Object]) -> None:
    """Refuse meshes of a damaged file whose faces, corners or edges refer to what does not exist.

    Blender reads such a .blend without a message. Dividing its faces into triangles takes up to minutes, then Blender
    crashes.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Mesh objects of the file.

    Raises
    ------
    InvalidMeshError
        If a mesh is damaged.
    """
    # Blender has made a mesh in Edit Mode anew, and it has no such attributes
    damaged = [obj.name for obj in objects if not obj.data.is_editmode and not _is_whole(obj.data)]
    if damaged:
        raise InvalidMeshError(
            f"{', '.join(damaged)}: the mesh is damaged; its faces refer to corners, edges or vertices that do not "
            "exist. Use an earlier version of the file."
        )


def _is_whole(mesh: bpy.types.Mesh) -> bool:
    """Return whether each face is a range of corners after the last, and all corners and edges exist."""
    starts, counts = (np.empty(len(mesh.polygons), dtype=np.int32) for _ in range(2))
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.polygons.foreach_get("loop_total", counts)
    return (
        bool((counts > 0).all())
        and np.array_equal(np.cumsum(np.append(0, counts), dtype=np.int64), np.append(starts, len(mesh.loops)))
        and _refers(mesh, ".corner_vert", len(mesh.vertices))
        and _refers(mesh, ".corner_edge", len(mesh.edges))
        and _refers(mesh, ".edge_verts", len(mesh.vertices), each=2)
    )


def _refers(mesh: bpy.types.Mesh, name: str, targets: int, each: int = 1) -> bool:
    """Return whether an attribute exists and all its indices refer to a target."""
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return False
    indices = np.empty(each * len(attribute.data), dtype=np.int32)
    attribute.data.foreach_get("value", indices)  # all at once; properties of corners would be copied one by one
    return not len(indices) or bool(indices.min() >= 0 and indices.max() < targets)
