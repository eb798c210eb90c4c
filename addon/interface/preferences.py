"""The preferences of the extension."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

import bpy
from bpy.props import BoolProperty

from ..blender.words.wording import CONTEXT

PACKAGE = (__package__ or "").rpartition(".addon.")[0] or "canonical_form"  # the extension's name in Blender


class CanonicalFormPreferences(bpy.types.AddonPreferences):
    """What the extension does by itself."""

    bl_idname = PACKAGE

    switch_shading: BoolProperty(  # type: ignore[valid-type]
        name="Show Colours after a Run",
        translation_context=CONTEXT,
        description="Switch solid shading to the colours of the result, and back when it is cleared",
        default=True,
    )

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the options."""
        self.layout.prop(self, "switch_shading")


def switches_shading(context: bpy.types.Context) -> bool:
    """Return whether to switch the shading of the 3D Views.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    bool
        The preference.
    """
    entry = context.preferences.addons.get(PACKAGE)
    return entry is None or entry.preferences is None or bool(entry.preferences.switch_shading)


register, unregister = bpy.utils.register_classes_factory((CanonicalFormPreferences,))
