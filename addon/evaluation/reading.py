"""Reads the mesh of a file: .off files directly, .obj and .ply with or without Blender, other kinds with Blender.

Blender may crash on a damaged file, so it reads in a separate process.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import cast

from ..blender.files.kinds_of_files import PLAIN
from ..blender.files.plain_files import has_blender, read_plain
from ..blender.files.polygon_mesh import fans
from ..core import InvalidMeshError
from ..core.numerics.arrays import FloatArray, IntArray
from ..scheduling.attempts import Failure
from ..scheduling.crews import LocalCrew


class Reader:
    """Reads meshes one by one; with Blender in another process, as it may crash."""

    def __init__(self) -> None:
        self._process = LocalCrew(1, attempts=2)  # the previous file may have killed it

    def triangles(self, path: Path) -> tuple[FloatArray, IntArray]:
        """Read the only mesh of a file.

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
            If the file cannot be read, contains more than one mesh, or crashes Blender.
        """
        plain = _plain_triangles(path)
        if plain is not None:
            return plain
        ((_, found),) = self._process.results(iter([(path, (_read_by_blender, (path,)))]))
        if not isinstance(found, Failure):
            return cast("tuple[FloatArray, IntArray]", found)
        if found.died:
            raise InvalidMeshError(
                f"Blender crashed on {path.name}; it may be damaged, or the memory was not enough. Open it in another "
                "program and export it again, or leave it out."
            )
        raise InvalidMeshError(found.reason)

    def close(self) -> None:
        """End the other process."""
        self._process.close()


def _plain_triangles(path: Path) -> tuple[FloatArray, IntArray] | None:
    """Read a file that does not need Blender; .obj and .ply are left to Blender if it is installed."""
    if path.suffix.lower() != ".off" and (path.suffix.lower() not in PLAIN or has_blender()):
        return None
    mesh = read_plain(path)
    if any(len(corners) != 3 for corners in mesh.polygons):
        return None
    return mesh.vertices, fans(mesh.polygons)


def load_blender() -> None:
    """Import Blender as a module in this process.

    If the parent process has loaded Blender, it passed on Blender's folders, which contain an incomplete bpy.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    sys.path[:] = [folder for folder in sys.path if Path(folder).parts[-2:] != ("scripts", "modules")]
    import bpy  # noqa: F401


def _read_by_blender(path: Path) -> tuple[FloatArray, IntArray]:
    """Read a file in this process, which Blender may crash."""
    try:
        load_blender()
    except ImportError as error:
        raise InvalidMeshError(
            f"{path.name} can only be read by Blender as a module: pip install bpy. Triangles in .off, .obj and .ply "
            "files need none."
        ) from error
    from ..blender.files.reading_files import open_meshes
    from ..blender.objects.mesh_reading import read_mesh

    try:
        objects = open_meshes(path)
    except (OSError, RuntimeError) as error:  # Blender's operators raise RuntimeError
        raise InvalidMeshError(str(error)) from error
    if len(objects) > 1:
        raise InvalidMeshError(f"{path.name} holds {len(objects)} meshes; an evaluation needs one a file.")
    return read_mesh(objects[0].data)
