"""Opens files of others in the window, as File > Import does, and the tab of the sidebar."""

import bpy

IMPORTERS = {".glb": "import_scene.gltf", ".obj": "wm.obj_import", ".ply": "wm.ply_import"}


def import_file(path):
    """Import a file as Blender does by itself."""
    group, name = IMPORTERS[path.suffix].split(".")
    getattr(getattr(bpy.ops, group), name)(filepath=str(path))
