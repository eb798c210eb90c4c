"""What of a file is the user's: read to be compared."""

import re
from typing import Any

import bpy
import numpy as np

from tests.meshes import shapes

QUICK: dict[str, Any] = {"max_iterations": 2, "landmark_count": 10, "quality": "draft"}


def orphans():
    """Count the data that nobody uses; of keys Blender's own count is wrong where a mesh was copied."""
    used = {mesh.shape_keys for mesh in bpy.data.meshes}
    return sum(keys not in used for keys in bpy.data.shape_keys) + sum(
        each.users == 0 for kind in (bpy.data.meshes, bpy.data.objects, bpy.data.actions) for each in kind
    )


def differing(before, after):
    """Name what differs, short."""
    if not isinstance(before, dict):
        return str(before)[:80], str(after)[:80]
    return {name: [str(each.get(name))[-60:] for each in (before, after)] for name in before.keys() | after.keys()
            if before.get(name) != after.get(name)}  # fmt: skip


def valued_keys(objects, read_record):
    """Name the keys whose value a step may set: to 0, or (True) to that of the slider, at the end of in-betweens."""
    found: dict[str, bool] = {}
    for mesh in [obj.data for obj in objects if obj is not None]:
        record, keys = read_record(mesh), mesh.shape_keys
        found |= dict.fromkeys(record.keys if record else (), False)
        curves = keys.animation_data.drivers if keys and keys.animation_data else []
        found |= {curve.data_path.split('"')[1]: bool(re.search(r"\* (\d+) - \1\)", curve.driver.expression))
                  for curve in curves if curve.data_path.endswith(".value")}  # fmt: skip
    return found


def leave_out_results(before, after, written, valued):
    """Leave out of views the new keys that were written, and values that a step may set."""
    for keys in after.keys() & {"keys", "hat keys"}:
        after[keys] = {name: value for name, value in after[keys].items()
                       if name in before[keys] or name not in written}  # fmt: skip
        for name in valued.keys() & before[keys].keys() & after[keys].keys():
            old, new = before[keys][name], after[keys][name]
            if valued[name] or new[1] == 0:
                before[keys][name] = (old[0], new[1], *old[2:])


def positions(key):
    points = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", points)
    return points.tobytes()


def colours(attribute):
    values = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", values)
    return attribute.data_type, attribute.domain, values.tobytes()


def add_hat(points):
    """Add an object that touches the walker, with data of the user's."""
    vertices, faces = shapes.sphere(2)
    mesh = bpy.data.meshes.new("Hat")
    mesh.from_pydata((0.5 * vertices).tolist(), [], faces.tolist())
    hat = bpy.data.objects.new("Hat", mesh)
    bpy.context.scene.collection.objects.link(hat)
    hat.location = points[np.argmax(points[:, 2])]
    hat.shape_key_add(name="Basis", from_mix=False)
    hat.shape_key_add(name="Tip", from_mix=False).data[3].co.z += 1
    hat.vertex_groups.new(name="Brim").add([0, 1, 2], 0.5, "REPLACE")
