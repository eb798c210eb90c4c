"""Reads the mesh of a file: plain .off files directly, all else through Blender, as the command `compute` does."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..blender.off_format import read_off
from ..core import InvalidMeshError
from ..core.surface import FloatArray, IntArray


def read_triangles(path: Path) -> tuple[FloatArray, IntArray]:
    """Read the one mesh of a file.

    Parameters
    ----------
    path : Path
        A .off, .obj, .ply, .stl, .glb or .blend file.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Raises
    ------
    InvalidMeshError
        If it cannot be read, or holds more than one mesh.
    """
    if path.suffix.lower() == ".off":
        vertices, polygons = read_off(path)
        if all(len(corners) == 3 for corners in polygons):
            return vertices, np.array(polygons, dtype=np.int64).reshape(-1, 3)
    try:
        import bpy  # noqa: F401
    except ImportError as error:
        raise InvalidMeshError(
            f"{path.name} can only be read by Blender as a module: pip install bpy. Triangles in .off files need none."
        ) from error
    from ..blender.files import open_meshes
    from ..blender.mesh_reading import read_mesh

    with _blender_silenced():
        objects = open_meshes(path)
    if len(objects) > 1:
        raise InvalidMeshError(f"{path.name} holds {len(objects)} meshes; an evaluation needs one a file.")
    return read_mesh(objects[0].data)


@contextmanager
def _blender_silenced() -> Iterator[None]:
    """Keep what Blender's importers print out of the progress bar."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(nowhere)
        os.close(kept)
