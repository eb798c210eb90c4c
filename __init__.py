"""Blender's door to the extension: everything else lives in `addon`."""


def register() -> None:
    """Register the extension with Blender."""
    from . import addon

    addon.register()


def unregister() -> None:
    """Take the extension out of Blender again."""
    from . import addon

    addon.unregister()
