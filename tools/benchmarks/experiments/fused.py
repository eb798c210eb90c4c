"""Bodies whose skin has grown together: poses under Blender's voxels, against the form of the first pose."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial import KDTree

from addon.core import CanonicalForm, Settings, canonical_form
from addon.core.mesh.geometry import surface_area, vertex_areas, vertex_normals
from tests.meshes.fused import apart
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import timed
from tools.benchmarks.mesh_sets import Body, folders, shown

VOXEL = 0.014  # of sqrt(area)
FACING = 0.03  # weight of normals in the search for the nearest vertex, in sqrt(area)
FAR = 0.1  # distance above which a form has to be told
WAYS = {"as it is": "keep", "found": "open", "beside the first pose": "reference"}
TOLD = ("contacts_opened", "contacts_left", "contacts_left_beside", "contacts_unknown", "handles")


@experiment("fused", folders, settings=WAYS)
def fused(body: Body, way: str) -> Iterator[Row]:
    """Every pose but the first remeshed by Blender's voxels of .014, so that skin that touches grows together; needs
    bpy. *distance*: of its form from that of the first pose, root mean square; *untold*: of those that are over .1
    away, which no warning tells of.
    """
    poses, faces = body.poses.vertices, body.poses.faces
    first = canonical_form(poses[0], faces, Settings(contacts="keep"))
    truth = first.vertices / np.sqrt(surface_area(first.vertices, faces))
    settings = Settings(contacts="keep" if way == "keep" else "open")
    distances, seconds, forms = [], [], []
    for pose in poses[1:]:
        points, triangles, origin = voxelised(pose, faces)
        reference = first if way == "reference" else None
        form, took = timed(canonical_form, points, triangles, settings, reference=reference)
        forms.append(form)
        seconds.append(took)
        shape = form.vertices / np.sqrt(surface_area(points, triangles))
        distances.append(apart(shape, truth[origin], vertex_areas(points, triangles)))
    far = np.array(distances) > FAR
    yield {
        "poses": len(distances),
        "parted": sum(form.parted is not None for form in forms),
        "distance": np.mean(distances),
        "most": max(distances),
        "over .1": int(far.sum()),
        "untold": sum(not told(form) for form, over in zip(forms, far, strict=True) if over),
        "seconds": np.median(seconds),
    }


def voxelised(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Remesh a surface by voxels; also the vertex that each of the new ones comes from."""
    import bpy

    unit = np.sqrt(surface_area(vertices, faces))
    mesh = bpy.data.meshes.new("pose")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("pose", mesh)
    bpy.context.scene.collection.objects.link(obj)
    modifier = obj.modifiers.new("voxels", "REMESH")
    modifier.mode, modifier.voxel_size = "VOXEL", VOXEL * unit
    points, triangles = shown([obj])
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(mesh)
    one, two = (
        np.column_stack([each / unit, FACING * vertex_normals(each, own)])
        for each, own in ((vertices, faces), (points, triangles))
    )
    return points, triangles, KDTree(one).query(two)[1]


def told(form: CanonicalForm) -> bool:
    """Return whether a warning says that skin has grown together."""
    return any(each.kind in TOLD for each in form.warnings)
