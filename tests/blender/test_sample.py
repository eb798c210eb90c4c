import bpy
import numpy as np

from addon.blender.objects.mesh_reading import read_mesh
from addon.core.assembly.bodies import bodies_of
from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import signed_volume
from tools.sample.posed_figure import build
from tools.sample.run import save_upright


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


def test_the_sample_file_stands_upright_in_blender(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    figure = build(levels=1)
    written = read_mesh(figure.data)[0]
    save_upright(tmp_path / "figure.obj", figure)
    bpy.ops.wm.obj_import(filepath=str(tmp_path / "figure.obj"))
    read = bpy.context.object
    placed = read_mesh(read.data)[0] @ np.array(read.matrix_world)[:3, :3].T
    np.testing.assert_allclose(placed, written, atol=1e-5)
