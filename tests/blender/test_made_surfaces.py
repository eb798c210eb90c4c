"""Surfaces that modifiers or instances make, and two copies of the extension."""

import shutil
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from tests.commands import ROOT, run
from tests.meshes import shapes

bpy = pytest.importorskip("bpy")
from addon.blender.records.record import require_record  # noqa: E402
from addon.core import Settings, canonical_form  # noqa: E402
from tests.blender.conftest import QUICK, add_object  # noqa: E402

USD = """#usda 1.0
(
    defaultPrim = "Root"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "Root"
{{
{instances}
}}
class Xform "Prototype"
{{
    def Mesh "Figure"
    {{
        int[] faceVertexCounts = [{counts}]
        int[] faceVertexIndices = [{corners}]
        point3f[] points = [{points}]
    }}
}}
"""


def test_hidden_helpers_are_left_out_as_shown(blender, arrays):
    """A character with geometry that a Mask hides, as bodies of makers of humans have."""
    vertices, faces = arrays
    ball, corners = shapes.sphere(2)
    helper = 0.5 * ball + vertices[np.argmax(vertices[:, 2])]
    obj = add_object("Body", np.vstack([vertices, helper]), np.vstack([faces, corners + len(vertices)]))
    obj.vertex_groups.new(name="body").add(range(len(vertices)), 1.0, "REPLACE")
    obj.modifiers.new("Hide helpers", "MASK").vertex_group = "body"
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form(**QUICK, mesh="SHOWN") == {"FINISHED"}
    made = bpy.data.objects["Body Canonical Form"].data
    assert len(made.vertices) == len(vertices)
    wanted = canonical_form(vertices, faces, Settings(**QUICK)).vertices
    shown = np.array([point.co for point in made.shape_keys.key_blocks["Canonical Form"].data])
    np.testing.assert_allclose(shown, wanted, atol=1e-4)
    assert bpy.ops.object.canonical_form(**QUICK) == {"FINISHED"}
    assert any("hide parts of it" in told for told in require_record(obj.data).report.warnings)


def nodes_of(obj, node):
    """Replace what an object shows by what a node makes, of its points if it takes any."""
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    given, result, made = (tree.nodes.new(name) for name in ("NodeGroupInput", "NodeGroupOutput", node))
    if node == "GeometryNodeInstanceOnPoints":
        cube = tree.nodes.new("GeometryNodeMeshCube")
        tree.links.new(given.outputs[0], made.inputs["Points"])
        tree.links.new(cube.outputs[0], made.inputs["Instance"])
    tree.links.new(made.outputs[0], result.inputs[0])
    obj.modifiers.new("Nodes", "NODES").node_group = tree


def test_a_surface_that_nodes_make_of_points_has_a_form_as_shown(blender):
    obj = add_object("Points", np.array([[0.0, 0, 0], [1, 0, 0]]), np.zeros((0, 3), dtype=int))
    nodes_of(obj, "GeometryNodeMeshUVSphere")
    with pytest.raises(RuntimeError, match="no faces"):
        bpy.ops.object.canonical_form(**QUICK)
    assert bpy.ops.object.canonical_form(mesh="SHOWN", **QUICK) == {"FINISHED"}
    assert len(bpy.data.objects["Points Canonical Form"].data.polygons) > 100
    assert not obj.data.polygons


@pytest.mark.parametrize(
    ("node", "told"),
    [("GeometryNodeInstanceOnPoints", "Realize Instances"), ("GeometryNodePoints", "shows no faces")],
)
def test_what_shows_no_surface_of_its_own_is_refused_by_name(blender, node, told):
    obj = add_object("Thing", *shapes.figure(11))
    nodes_of(obj, node)
    with pytest.raises(RuntimeError, match=told):
        bpy.ops.object.canonical_form(mesh="SHOWN", **QUICK)


def test_every_instance_of_a_usd_file_has_a_form_at_its_place(tmp_path):
    vertices, faces = shapes.figure(11)
    instances = "".join(
        f'def Xform "I{number}" (\n instanceable = true\n references = </Prototype>\n)\n{{\n'
        f"double3 xformOp:translate = ({9 * number}, 0, 0)\n"
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
        for number in range(3)
    )
    (tmp_path / "crowd.usda").write_text(
        USD.format(
            instances=instances,
            counts=", ".join("3" for _ in faces),
            corners=", ".join(map(str, faces.ravel())),
            points=", ".join(str(tuple(point)) for point in vertices.tolist()),
        )
    )
    code, lines, _ = run(tmp_path / "crowd.usda", "--output", tmp_path / "out", "--format", "ply")
    assert code == 0
    assert len(lines) == 3
    places = []
    for line in lines:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.ply_import(filepath=line["output"])
        places.append(np.mean([vertex.co.x for vertex in bpy.context.object.data.vertices]))
    np.testing.assert_allclose(np.diff(sorted(places)), 9, atol=0.1)


def test_a_second_copy_stays_off_with_a_sentence_and_harms_nothing(tmp_path):
    shutil.copytree(ROOT / "addon", tmp_path / "other", ignore=shutil.ignore_patterns("__pycache__"))
    script = """
        import sys
        sys.path.insert(0, sys.argv[1])
        import bpy, addon, other
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for step in (addon.register, other.register, other.unregister):
            step()
            assert "canonical_form" in dir(bpy.ops.object)
        addon.unregister()
        other.register()
        addon.register()
        addon.unregister()
        assert "canonical_form" in dir(bpy.ops.object)
        other.unregister()
        assert "canonical_form" not in dir(bpy.ops.object)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), str(tmp_path)], cwd=ROOT, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.count("enabled twice") == 2
