"""The panels in the 3D View's sidebar, tab Canonical Form, from top to bottom."""

import bpy

from . import main_panel, research_panel, result_panel, rig_panel, tool_panels

CLASSES = (
    *main_panel.CLASSES,
    *result_panel.CLASSES,
    *rig_panel.CLASSES,
    *tool_panels.CLASSES,
    *research_panel.CLASSES,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
