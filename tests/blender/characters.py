"""Steps on a character of several objects (the fixture `character`)."""

import bpy

from .conftest import QUICK

KEY = "Canonical Form"


def run(**options):
    return bpy.ops.object.canonical_form(**{**QUICK, **options})


def key_of(obj):
    return obj.data.shape_keys.key_blocks[KEY]


def activate(*objects):
    """Select objects, and make the first active."""
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]
