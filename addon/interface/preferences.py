"""The preferences of the extension."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from pathlib import Path

import bpy
from bpy.props import BoolProperty

from ..blender.words.wording import CONTEXT, told
from .viewport import restore_shading, show_colours

_GUIDE = Path(__file__).parents[1] / "guide"  # made of the documents when the extension is packed
FIRST, OPTIONS, TROUBLE = "user-guide.html", "options.html", "troubleshooting.html"
PACKAGE = (__package__ or "").rpartition(".addon.")[0] or "canonical_form"  # the extension's name in Blender


class CanonicalFormPreferences(bpy.types.AddonPreferences):
    """What the extension does by itself."""

    bl_idname = PACKAGE

    show_colours: BoolProperty(  # type: ignore[valid-type]
        name="Show Colours",
        translation_context=CONTEXT,
        description="Show the colours of results, a limb each, in solid shading; the mesh keeps its materials",
        default=False,
        update=lambda own, context: show_colours(context) if own.show_colours else restore_shading(context),
    )

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the options, and where everything else is."""
        layout = self.layout
        layout.label(text=told("It is in the sidebar of the 3D View: press N, tab Canonical Form"), icon="INFO")
        layout.prop(self, "show_colours")
        if not _GUIDE.is_dir():  # a checkout has the documents themselves
            return
        row = layout.row()
        for text, page in (
            (told("First Steps"), FIRST),
            (told("Options"), OPTIONS),
            (told("Troubleshooting"), TROUBLE),
        ):
            row.operator("wm.url_open", text=text, icon="HELP").url = (_GUIDE / page).as_uri()


def preferences_of(context: bpy.types.Context) -> CanonicalFormPreferences | None:
    """Return the preferences.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    CanonicalFormPreferences or None
        Those of the extension; None if it was registered by a script.
    """
    entry = context.preferences.addons.get(PACKAGE)
    return None if entry is None else entry.preferences


def show_colours_if_wished(context: bpy.types.Context) -> None:
    """Show the colours of a result, if the preferences say so.

    Parameters
    ----------
    context : bpy.types.Context
        Any context with windows.
    """
    preferences = preferences_of(context)
    if preferences is not None and preferences.show_colours:
        show_colours(context)


register, unregister = bpy.utils.register_classes_factory((CanonicalFormPreferences,))
