"""References in a file to files outside its folder: results of an untrusted file must not contain them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import bpy

from ...core import InvalidMeshError

_GLB_MAGIC, _GLB_HEAD = b"glTF", 20  # bytes before the JSON: the headers of the file and of its first chunk


def require_own_buffers(path: Path) -> None:
    """Reject a glTF file with mesh buffers outside its folder, as any file can be read as numbers.

    Parameters
    ----------
    path : Path
        A .gltf or .glb file. A damaged file is left to Blender's importer.

    Raises
    ------
    InvalidMeshError
        If it refers to such a buffer.
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
    """Return whether a path is a folder or lies in it at any depth, with links resolved.

    Parameters
    ----------
    path, folder : Path
        The path and the folder; neither needs to exist.

    Returns
    -------
    bool
        True if it does.

    Examples
    --------
    >>> is_below(Path("scans/../secret.png"), Path("scans"))
    False
    """
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # not a valid path, or circular links
        return False


@contextmanager
def without_foreign_pictures(objects: Sequence[bpy.types.Object], folder: Path | None) -> Iterator[list[str]]:
    """Temporarily remove images outside a folder from the materials of objects.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects.
    folder : Path or None
        The folder; None to keep every image.

    Yields
    ------
    list of str
        Names of the removed images.
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


def pictures_not_held(objects: Sequence[bpy.types.Object], kind: str) -> list[str]:
    """Return the names of the images of objects that do not come along in a file.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects.
    kind : str
        Kind of file.

    Returns
    -------
    list of str
        Images whose files are missing, and, where the file only names its pictures, those packed into the input.
    """
    materials = [slot.material for obj in objects for slot in obj.material_slots if slot.material is not None]
    found = set()
    for node in _nodes([each.node_tree for each in materials]):
        image = getattr(node, "image", None)
        if image is None or image.source not in ("FILE", "TILED"):
            continue
        packed = image.packed_file is not None
        missing = not packed and not Path(bpy.path.abspath(image.filepath, library=image.library)).exists()
        if (missing and image.source == "FILE") or (packed and kind in ("obj", "usdc")):
            found.add(image.name)
    return sorted(found)


def _description(path: Path) -> Any:
    """Read the JSON of a .gltf file, or that at the start of a .glb file."""
    with path.open("rb") as file:
        head = file.read(_GLB_HEAD)
        if head[:4] == _GLB_MAGIC:
            return json.loads(file.read(int.from_bytes(head[12:16], "little")))
        return json.loads(head + file.read())


def _is_foreign(image: bpy.types.Image, folder: Path) -> bool:
    """Return whether an image is loaded from a file outside a folder."""
    if image.packed_file is not None or not image.filepath:
        return False
    return not is_below(Path(bpy.path.abspath(image.filepath, library=image.library)), folder)


def _nodes(trees: list[bpy.types.NodeTree | None]) -> Iterator[bpy.types.Node]:
    """Iterate over the nodes of node trees and their nested groups, each tree once."""
    seen = set()
    while trees:
        tree = trees.pop()
        if tree is None or tree in seen:
            continue
        seen.add(tree)
        for node in tree.nodes:
            yield node
            trees.append(getattr(node, "node_tree", None))
