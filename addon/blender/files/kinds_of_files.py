"""The kinds of files that can be read and written, defined without Blender."""

from __future__ import annotations

IMPORTERS = {  # Blender's operators by file kind; the first that exists is used
    ".obj": ("wm.obj_import",),
    ".ply": ("wm.ply_import",),
    ".stl": ("wm.stl_import",),
    ".glb": ("import_scene.gltf",),
    ".gltf": ("import_scene.gltf",),
    ".fbx": ("wm.fbx_import", "import_scene.fbx"),
    ".usd": ("wm.usd_import",),
    ".usda": ("wm.usd_import",),
    ".usdc": ("wm.usd_import",),
    ".usdz": ("wm.usd_import",),
    ".abc": ("wm.alembic_import",),
}
READ = (".blend", ".off", *IMPORTERS)
EXPORTERS = {"glb": "export_scene.gltf", "fbx": "export_scene.fbx", "usdc": "wm.usd_export", "usdz": "wm.usd_export"}
PLAIN = (".off", ".obj", ".ply")  # read and written without Blender; they hold one object
WRITTEN = ("blend", "obj", "ply", *EXPORTERS, "off")
