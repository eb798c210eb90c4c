"""What a file names outside its own folder: a stranger's could carry such files away in the results."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import bpy

from ...core import InvalidMeshError

_GLB_MAGIC, _GLB_HEAD = b"glTF", 20  # bytes before the description: of the file and of its first chunk


def require_own_buffers(path: Path) -> None:
    """Refuse a glTF file that takes the arrays of its meshes from outside its folder: any file may be read as numbers.

    Parameters
    ----------
    path : Path
        A .gltf or .glb file. A damaged one is left to Blender's reader.

    Raises
    ------
    InvalidMeshError
        If it names such a buffer.
    """
    try:
        described = _description(path)
        buffers = described.get("buffers", []) if isinstance(described, dict) else []
        uris = [each.get("uri") for each in buffers if isinstance(each, dict)]
    except (ValueError, RecursionError, TypeError):
        return
    for uri in uris:
        if (
            isinstance(uri, str)
            and not uri.startswith("data:")
            and not is_below(path.parent / unquote(uri), path.parent)
        ):
            raise InvalidMeshError(
                f"{path.name} takes its meshes from a file outside its folder, {uri!r:.200}. If you trust it, add "
                "--trust-scripts, or move that file beside it."
            )


def is_below(path: Path, folder: Path) -> bool:
    """Tell whether a file lies in a folder or below it, wherever links lead.

    Parameters
    ----------
    path, folder : Path
        The file and the folder, there or not.

    Returns
    -------
    bool
        Whether it does.

    Examples
    --------
    >>> is_below(Path("scans/../secret.png"), Path("scans"))
    False
    """
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # no path at all, or links in a circle
        return False


@contextmanager
def without_foreign_pictures(objects: Sequence[bpy.types.Object], folder: Path | None) -> Iterator[list[str]]:
    """Take the pictures from outside a folder out of the materials of objects for a while.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects.
    folder : Path or None
        The folder; None where every picture may stay.

    Yields
    ------
    list of str
        Names of the pictures that are out.
    """
    materials = [slot.material for obj in objects for slot in obj.material_slots if slot.material is not None]
    taken = [
        (node, node.image)
        for node in _nodes([each.node_tree for each in materials])
        if folder is not None and getattr(node, "image", None) is not None and _is_foreign(node.image, folder)
    ]
    try:
        for node, _ in taken:
            node.image = None
        yield sorted({image.name for _, image in taken})
    finally:
        for node, image in taken:
            node.image = image


def _description(path: Path) -> Any:
    """Read the JSON of a .gltf, or that at the head of a .glb."""
    with path.open("rb") as file:
        head = file.read(_GLB_HEAD)
        if head[:4] == _GLB_MAGIC:
            return json.loads(file.read(int.from_bytes(head[12:16], "little")))
        return json.loads(head + file.read())


def _is_foreign(image: bpy.types.Image, folder: Path) -> bool:
    """Return whether a picture is read from a file that lies outside a folder."""
    if image.packed_file is not None or not image.filepath:
        return False
    return not is_below(Path(bpy.path.abspath(image.filepath, library=image.library)), folder)


def _nodes(trees: list[bpy.types.NodeTree | None]) -> Iterator[bpy.types.Node]:
    """List the nodes of node trees and of the groups within, each tree once."""
    seen = set()
    while trees:
        tree = trees.pop()
        if tree is None or tree in seen:
            continue
        seen.add(tree)
        for node in tree.nodes:
            yield node
            trees.append(getattr(node, "node_tree", None))
