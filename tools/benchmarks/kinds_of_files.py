"""The kinds of files that this Blender reads and writes: a row of the table in docs/scripting.md.

Run ``python tools/benchmarks/kinds_of_files.py`` with any Python that has bpy, numpy and scipy. A figure is written in
every kind that Blender exports and computed from these files, and its form is written in every kind and read again.
"""

import io
import json
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.batch.command import main
from addon.blender.files.reading_files import open_meshes
from tests.meshes import shapes

SOURCES = {  # by kind: the exporter in Blender
    "blend": lambda path: bpy.ops.wm.save_as_mainfile(filepath=path, copy=True),
    "off": lambda path: shapes.write_off(Path(path), *shapes.figure(18)),
    "obj": lambda path: bpy.ops.wm.obj_export(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_export(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_export(filepath=path),
    "glb": lambda path: bpy.ops.export_scene.gltf(filepath=path),
    "gltf": lambda path: bpy.ops.export_scene.gltf(filepath=path, export_format="GLTF_SEPARATE"),
    "fbx": lambda path: bpy.ops.export_scene.fbx(filepath=path),
    "usda": lambda path: bpy.ops.wm.usd_export(filepath=path),
    "usdc": lambda path: bpy.ops.wm.usd_export(filepath=path),
    "usdz": lambda path: bpy.ops.wm.usd_export(filepath=path),
    "abc": lambda path: bpy.ops.wm.alembic_export(filepath=path, as_background_job=False),
}
QUICK = ["--max-iterations", "5", "--landmark-count", "20"]


def figure() -> None:
    """Add the figure to an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(18)
    mesh = bpy.data.meshes.new("Figure")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Figure", mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def computed(*words: str) -> list[dict]:
    """Run the command and return its result lines."""
    output = io.StringIO()
    main(["compute", *words, *QUICK], output, alone=True)
    return [json.loads(line) for line in output.getvalue().splitlines()]


def size(path: str) -> float:
    """Measure the form in a file: its largest extent divided by its smallest."""
    (obj,) = open_meshes(Path(path))
    extent = np.ptp([obj.matrix_world @ vertex.co for vertex in obj.data.vertices], axis=0)
    return float(extent.max() / extent.min())


def run() -> None:
    """Print the kinds that are read and written."""
    read, written = {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for kind, write in SOURCES.items():
            path = str(Path(folder) / f"figure.{kind}")
            figure()
            try:
                write(path)
                (line,) = computed(path, "--output", f"{folder}/out-{kind}")
                read[kind] = line["measures"]["edge_distortion_median"] if "measures" in line else line["error"]
            except (RuntimeError, AttributeError) as error:
                read[kind] = f"not written by Blender to try it: {str(error).strip()[:60]}"
        source = str(Path(folder) / "figure.off")
        for kind in ("obj", "ply", "glb", "fbx", "usdc"):
            (line,) = computed(source, "--output", f"{folder}/forms", "--format", kind)
            written[kind] = line["error"] if "error" in line else size(line["output"])
    print(bpy.app.version_string, json.dumps({"read": read, "written": written}, indent=1), file=sys.stderr)


if __name__ == "__main__":
    run()
