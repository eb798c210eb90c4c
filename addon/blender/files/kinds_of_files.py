"""Which kinds of files there are to read and write, told without Blender."""

from __future__ import annotations

IMPORTERS = {  # operators of Blender by kind, the first that it has is taken
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
EXPORTERS = {"glb": "export_scene.gltf", "fbx": "export_scene.fbx", "usdc": "wm.usd_export"}
WRITTEN = ("blend", "obj", "ply", *EXPORTERS)
PLAIN = (".off", ".obj", ".ply")  # read and written without Blender, positions and polygons alone
