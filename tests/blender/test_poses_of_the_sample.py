"""The project's own figure at rest and posed: the same numbers, the same way up, one form on the other."""

import bpy
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.blender.objects.mesh_reading import read_object
from addon.core import Settings, canonical_form
from addon.core.measures.alignment import rigid_fit
from tools.sample import clothed_figure
from tools.sample.posed_figure import pose, rig, skin


@pytest.fixture(scope="module")
def poses():
    """Vertices at rest, vertices posed, and triangles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    figure = skin("Figure", 2)
    armature = rig(figure)
    bpy.context.view_layer.update()
    rest = read_object(figure, True)
    pose(armature)
    bpy.context.view_layer.update()
    return rest.vertices, read_object(figure, True).vertices, rest.faces


def test_limbs_keep_their_numbers_and_the_body_its_way_up(poses):
    rest, posed, faces = poses
    upright = Settings(orientation="upright")
    forms = [canonical_form(vertices, faces, upright) for vertices in (rest, posed)]
    places = rest[forms[0].feature_points]
    assert np.argmax(places[:, 2]) == 0  # the head comes first
    assert (np.sign(places[1:, 0]) * [1, -1, 1, -1]).tolist() in ([1.0] * 4, [-1.0] * 4)  # then pairs, side by side
    far = np.linalg.norm(rest[forms[1].feature_points][:, None] - places, axis=2)
    assert far.argmin(axis=1).tolist() == [0, 1, 2, 3, 4]
    turned = Rotation.from_matrix(rigid_fit(forms[0].vertices, forms[1].vertices)[0]).magnitude()
    assert np.degrees(turned) < 10
    tips = forms[0].vertices[forms[0].feature_points]
    assert tips[1:3, 2].mean() > tips[3:, 2].mean()  # hands above feet


def test_the_posed_form_lies_on_that_at_rest(poses):
    rest, posed, faces = poses
    reference = canonical_form(rest, faces)
    form = canonical_form(posed + 7.0, faces, reference=reference)
    rotation, shift = rigid_fit(form.vertices, reference.vertices)
    apart = [
        np.sqrt(((each - reference.vertices) ** 2).sum(axis=1).mean())
        for each in (form.vertices, form.vertices @ rotation + shift)
    ]
    assert apart[0] < 1.1 * apart[1]


def test_the_clothed_one_keeps_its_numbers_too():
    numbered = []
    for posed in (False, True):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        clothed_figure.build(levels=2, posed=posed)
        for obj in bpy.data.objects:
            obj.select_set(obj.type == "MESH")
        import addon

        addon.register()
        bpy.context.view_layer.objects.active = bpy.data.objects["Body"]
        bpy.ops.object.canonical_form(mesh="SHOWN", max_iterations=3, objects="TOGETHER")
        groups: dict[str, list[tuple[str, int]]] = {}
        for obj in bpy.context.selected_objects:
            for group in obj.vertex_groups:
                if group.name.startswith("Patch"):
                    members = [v.index for v in obj.data.vertices if any(g.group == group.index for g in v.groups)]
                    groups.setdefault(group.name, []).extend((obj.name, member) for member in members)
        addon.unregister()
        numbered.append({name: set(members) for name, members in groups.items()})
    one, two = numbered
    assert set(one) == set(two)
    for name in one:
        assert len(one[name] & two[name]) > 0.8 * min(len(one[name]), len(two[name])), name
