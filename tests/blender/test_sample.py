import bpy
import numpy as np

from addon.blender.objects.mesh_reading import read_mesh
from addon.core.assembly.bodies import bodies_of
from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import signed_volume
from tools.sample.posed_figure import build


def test_the_posed_figure_is_one_closed_surface_and_the_pose_moves_it():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rest, posed = build("Rest", levels=1, posed=False), build("Posed", levels=1)
    shapes = [read_mesh(obj.data) for obj in (rest, posed)]
    for vertices, faces in shapes:
        found = bodies_of(vertices, faces)
        assert len(found.pieces.pieces) == 1
        assert not found.pieces.repairs + found.apart
        assert is_closed(faces)
        assert signed_volume(vertices, faces) > 0
    assert len(shapes[0][0]) == len(shapes[1][0])
    assert np.linalg.norm(shapes[0][0] - shapes[1][0], axis=1).max() > 0.3
    assert [obj.name for obj in bpy.data.objects] == ["Posed", "Rest"]
