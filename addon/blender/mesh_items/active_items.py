"""The active shape key, vertex group and colours of an object, by name: removing items shifts their indices."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import bpy


class ItemNames(NamedTuple):
    """Names of some items of a mesh, by kind.

    Attributes
    ----------
    shape_keys, groups, colours : collection of str or None
        Names of shape keys, vertex groups and colour attributes.
    """

    shape_keys: Collection[str | None] = ()
    groups: Collection[str | None] = ()
    colours: Collection[str | None] = ()

    def without(self, names: Collection[str]) -> ItemNames:
        """Remove names from all kinds.

        Parameters
        ----------
        names : collection of str
            Names to remove, whatever their kind.

        Returns
        -------
        ItemNames
            The remaining names.
        """
        kinds = (self.shape_keys, self.groups, self.colours)
        return ItemNames(*({name for name in kind if name not in names} for kind in kinds))


class ActiveItems(NamedTuple):
    """Names of the active items of an object; None where no item is active.

    Attributes
    ----------
    shape_key, group : str or None
        The active shape key and vertex group.
    colour, render_colour : str or None
        The colour attributes active in the viewport and for rendering.
    """

    shape_key: str | None = None
    group: str | None = None
    colour: str | None = None
    render_colour: str | None = None

    def kept(self, names: ItemNames, otherwise: ActiveItems) -> ActiveItems:
        """Keep the items whose names are listed and take the others from `otherwise`.

        Parameters
        ----------
        names : ItemNames
            Names of the items to keep.
        otherwise : ActiveItems
            Provides the other items.

        Returns
        -------
        ActiveItems
            The combined items.
        """
        return self._chosen(self._among(names), otherwise)

    def replaced(self, names: ItemNames, by: ActiveItems) -> ActiveItems:
        """Replace the items whose names are listed and keep the others.

        Parameters
        ----------
        names : ItemNames
            Names of the items to replace.
        by : ActiveItems
            Provides the replacements.

        Returns
        -------
        ActiveItems
            The combined items.
        """
        return self._chosen([not among for among in self._among(names)], by)

    def _among(self, names: ItemNames) -> list[bool]:
        return [
            self.shape_key in names.shape_keys,
            self.group in names.groups,
            self.colour in names.colours,
            self.render_colour in names.colours,
        ]

    def _chosen(self, keep: list[bool], other: ActiveItems) -> ActiveItems:
        pairs = zip(keep, self, other, strict=True)
        return ActiveItems(*(own if kept else replacement for kept, own, replacement in pairs))


def active_items(obj: bpy.types.Object) -> ActiveItems:
    """Return the active items of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, of type MESH.

    Returns
    -------
    ActiveItems
        Their names.
    """
    colours = obj.data.color_attributes
    render = colours.render_color_index
    return ActiveItems(
        shape_key=obj.active_shape_key.name if obj.active_shape_key else None,
        group=obj.vertex_groups.active.name if obj.vertex_groups.active else None,
        colour=colours.active_color.name if colours.active_color else None,
        render_colour=colours[render].name if 0 <= render < len(colours) else None,
    )


def restore_active_items(obj: bpy.types.Object, items: ActiveItems) -> None:
    """Make items of an object active; the first shape key or group replaces a missing one.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    items : ActiveItems
        Names of the items.
    """
    mesh = obj.data
    if mesh.shape_keys is not None and items.shape_key is not None:
        obj.active_shape_key_index = max(mesh.shape_keys.key_blocks.find(items.shape_key), 0)
    if items.group is not None:
        obj.vertex_groups.active_index = max(obj.vertex_groups.find(items.group), 0)
    if items.colour is not None and items.colour in mesh.color_attributes:
        mesh.color_attributes.active_color_name = items.colour
    if items.render_colour is not None and items.render_colour in mesh.color_attributes:
        mesh.color_attributes.render_color_index = mesh.color_attributes.find(items.render_colour)


def existing_items(obj: bpy.types.Object) -> ItemNames:
    """List the shape keys, vertex groups and colour attributes of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, of type MESH.

    Returns
    -------
    ItemNames
        All their names.
    """
    mesh = obj.data
    return ItemNames(
        shape_keys=mesh.shape_keys.key_blocks.keys() if mesh.shape_keys is not None else (),
        groups=obj.vertex_groups.keys(),
        colours=mesh.color_attributes.keys(),
    )


def active_keys_elsewhere(obj: bpy.types.Object) -> dict[bpy.types.Object, str | None]:
    """Return the active shape keys of the other objects that share the mesh of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    dict of bpy.types.Object to str or None
        Name of the active key of each object.
    """
    others = [other for other in bpy.data.objects if other.data == obj.data and other != obj]
    return {other: other.active_shape_key and other.active_shape_key.name for other in others}


def restore_active_keys(active: dict[bpy.types.Object, str | None]) -> None:
    """Make the same shape keys active again, if they still exist.

    Parameters
    ----------
    active : dict of bpy.types.Object to str or None
        As `active_keys_elsewhere` returns it.
    """
    for obj, name in active.items():
        keys = obj.data.shape_keys
        if keys is not None and name is not None and name in keys.key_blocks:
            obj.active_shape_key_index = keys.key_blocks.find(name)
