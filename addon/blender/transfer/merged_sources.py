"""The data of several meshes of one character as those of one mesh."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .transfer_reading import Source, SourceColours, SourceKey

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray, IntArray

    Part = tuple[Source, FloatArray]  # with the positions of its vertices

_NEUTRAL = 1.0  # white, opaque: the colour of what has none


def merged(name: str, parts: Sequence[Part]) -> Source:
    """Put the data of several meshes together: groups, colours and keys by name, UV maps in their order.

    Parameters
    ----------
    name : str
        How the whole is called.
    parts : sequence of (Source, (n, 3) ndarray of float)
        The data of each mesh, and its positions.

    Returns
    -------
    Source
        The data of all.
    """
    first = parts[0][0]
    if len(parts) == 1:
        return first._replace(name=name)
    corners = np.cumsum([0, *(len(data.vertex_of) for data, _ in parts)])
    vertices = np.cumsum([0, *(len(points) for _, points in parts)])
    slots = np.cumsum([0, *(len(data.materials) for data, _ in parts)])
    own = list(zip(parts, corners, vertices, slots, strict=False))
    colours = {(each.name, each.on_corners): each for data, _ in reversed(parts) for each in data.colours}
    keys = {each.name: each for data, _ in reversed(parts) for each in data.keys}
    return Source(
        name,
        np.concatenate([data.triangle_corners + start for (data, _), start, _, _ in own]),
        np.concatenate([data.vertex_of + start for (data, _), _, start, _ in own]),
        {group: _groups(group, parts) for group in _names(data.groups for data, _ in parts)},
        _uvs(parts),
        [_colours(each, parts) for each in colours.values()],
        [_key(each, parts) for each in keys.values()],
        [material for data, _ in parts for material in data.materials],
        np.concatenate([_slots(data, int(start)) for (data, _), _, _, start in own]),
        first.armature,
        _names(data.damaged for data, _ in parts),
    )


def _names(parts: Iterable[Iterable[str]]) -> list[str]:
    """List names in the order in which they come."""
    return list(dict.fromkeys(name for part in parts for name in part))


def _groups(name: str, parts: Sequence[Part]) -> FloatArray:
    """Put the weights of one group together; what is not in it has none."""
    return np.concatenate([data.groups.get(name, np.zeros(len(points))) for data, points in parts])


def _uvs(parts: Sequence[Part]) -> dict[str, FloatArray]:
    """Put the first UV maps together, the second ones, and so on; a mesh with fewer lends its first."""
    found = {}
    for number in range(max(len(data.uvs) for data, _ in parts)):
        name = next(list(data.uvs)[number] for data, _ in parts if len(data.uvs) > number)
        maps = []
        for data, _ in parts:
            own = list(data.uvs.values())
            maps.append(own[number if number < len(own) else 0] if own else np.zeros((len(data.vertex_of), 2)))
        found[name] = np.concatenate(maps)
    return found


def _colours(like: SourceColours, parts: Sequence[Part]) -> SourceColours:
    """Put one colour attribute together; what has none of that name and domain is white."""
    found = []
    for data, points in parts:
        own = next((x for x in data.colours if (x.name, x.on_corners) == (like.name, like.on_corners)), None)
        count = len(data.vertex_of) if like.on_corners else len(points)
        found.append(np.full((count, 4), _NEUTRAL) if own is None else own.values)
    return like._replace(values=np.concatenate(found))


def _key(like: SourceKey, parts: Sequence[Part]) -> SourceKey:
    """Put one shape key together; it does not move what does not have it."""
    own = [next((key for key in data.keys if key.name == like.name), None) for data, _ in parts]
    masks = {key.mask for key in own if key is not None}
    shapes = []
    for key, (data, points) in zip(own, parts, strict=True):
        shape = points if key is None else key.shape
        if key is not None and len(masks) > 1 and key.mask in data.groups:  # no one group masks all of them
            shape = points + data.groups[key.mask][:, None] * (shape - points)
        shapes.append(shape)
    return like._replace(shape=np.concatenate(shapes), mask=masks.pop() if len(masks) == 1 else "")


def _slots(data: Source, start: int) -> IntArray:
    """Return the slots of triangles among those of all; as Blender shows them, beyond the last it is the last."""
    if not data.materials:
        return np.full(len(data.material_of), -1)
    return np.minimum(data.material_of, len(data.materials) - 1) + start
