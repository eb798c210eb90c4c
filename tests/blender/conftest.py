"""Fixtures and helpers: a fresh Blender with the add-on registered, snapshots and drawn panels."""

import pickle
from copy import deepcopy
from typing import Any

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from mathutils import Euler, Matrix  # noqa: E402

import addon  # noqa: E402
from addon import core  # noqa: E402
from addon.blender.records.record import RECORD_PROPERTY  # noqa: E402
from addon.core.results import Match, Rigged  # noqa: E402
from addon.core.rigging.fitted_rig import rest_bends  # noqa: E402
from addon.core.rigging.reference_rig import mannequin_rig  # noqa: E402
from addon.core.rigging.skeleton import BoneMotions, moved_skeleton, skinned  # noqa: E402
from addon.core.surface.working_surface import working_surface  # noqa: E402
from tests.meshes import pieced, shapes  # noqa: E402
from tests.meshes.bent_rigs import posed  # noqa: E402

PLACES = {  # of each object: turned, scaled, mirrored
    "trunk": Matrix.Identity(4),
    "head": Matrix.LocRotScale((1.0, -2.0, 0.5), Euler((0.3, 0.2, -0.9)), (2.0, 2.0, 2.0)),
    "hand": Matrix.LocRotScale((0.0, 0.0, 3.0), Euler((0.0, 0.0, 1.0)), (-0.5, 0.5, 0.5)),
    "shirt": Matrix.LocRotScale((-1.0, 0.0, 0.0), Euler((1.0, 0.0, 0.0)), (1.0, 0.25, 3.0)),
    "eye": Matrix.Translation((0.0, 5.0, 0.0)),
}
BENDS = {"upper_arm.L": (0, 50, 10), "forearm.L": (0, 0, -40), "thigh.R": (-40, 0, 0), "shin.R": (50, 0, 0)}
QUICK: dict[str, Any] = {"max_iterations": 3, "landmark_count": 20}


@pytest.fixture(scope="module")
def computed_once():
    """Forms, matches and poses are functions of meshes and options: each is computed once for all tests of a file."""
    found: dict[bytes, Any] = {}

    def once(name):
        compute = getattr(core, name)

        def from_before(*arguments, progress=None, cancelled=None, keep=None, **more):
            key = pickle.dumps((name, arguments, more))
            if key not in found:
                how = {} if keep is None else {"keep": keep}
                found[key] = compute(*arguments, progress=progress, cancelled=cancelled, **more, **how)
            return deepcopy(found[key])

        return from_before

    with pytest.MonkeyPatch.context() as patch:
        for name in ("canonical_form", "match", "pose_like"):
            patch.setattr(core, name, once(name))
        yield


@pytest.fixture
def blender():
    """An empty file in which the add-on is registered."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    yield bpy
    addon.unregister()


@pytest.fixture(scope="session")
def arrays():
    """A small figure."""
    return shapes.figure(13)


@pytest.fixture
def figure_object(blender, arrays):
    """The small figure as the active object."""
    return add_object("Figure", *arrays)


@pytest.fixture(scope="session")
def made():
    """A character of pieces."""
    return pieced.character()[2]


@pytest.fixture
def character(blender, made):
    """The same as several objects, all selected, the body active."""
    objects = {}
    for name, place in PLACES.items():
        own = made.pieces[name]
        number = np.full(len(made.vertices), -1)
        number[own] = np.arange(len(own))
        faces = number[made.faces[np.isin(made.faces[:, 0], own)]]
        inverse = np.array(place.inverted())
        obj = add_object(name, made.vertices[own] @ inverse[:3, :3].T + inverse[:3, 3], faces)
        obj.matrix_world = place
        if np.linalg.det(np.array(place)[:3, :3]) < 0:
            obj.data.flip_normals()
        objects[name] = obj
    for obj in objects.values():
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects["trunk"]
    bpy.context.view_layer.update()
    return objects


@pytest.fixture(scope="session")
def lender():
    """A small mannequin with its bones."""
    vertices, faces = core.mannequin()
    coarse = working_surface(vertices, faces, 1500)
    return mannequin_rig(vertices, faces).at(coarse.kept, coarse.faces)


@pytest.fixture(scope="session")
def motions(lender):
    """How its bones are bent in the scan."""
    return posed(lender, BENDS)


@pytest.fixture(scope="session")
def scan(lender, motions):
    """The same body, bent."""
    return skinned(lender.vertices, lender.weights, motions)


@pytest.fixture
def known(monkeypatch, lender, motions, scan):
    """Let the core find the true bones at once, whatever the objects are; the costs of two ways to face."""
    nothing = np.zeros(len(scan), dtype=np.int64)
    sure = np.ones(len(scan))
    match = Match(nothing, nothing, np.ones((len(scan), 3)), sure, [1.0, 4.0], lender.faces, len(scan), {}, [], [])
    bones = lender.skeleton
    there = moved_skeleton(bones, motions)
    still = BoneMotions(there.heads, there.heads, np.broadcast_to(np.eye(3), motions.turns.shape))
    sure = np.ones(len(bones.names))
    sure[bones.names.index("toe.L")] = 0.01

    def found(vertices, faces, reference, settings, *, pose, **_):
        bends = rest_bends(lender)
        if pose is None:
            turned = np.einsum("bij,bj->bi", motions.turns, bends)
            return Rigged(vertices, there, still, turned, lender.weights, sure, match, {}, [])
        place = vertices[0] - scan[0]  # that of the object
        moved = BoneMotions(bones.heads + place, motions.heads + place, motions.turns)
        at_rest = bones._replace(heads=bones.heads + place, tails=bones.tails + place)
        return Rigged(lender.vertices + place, at_rest, moved, bends, lender.weights, sure, match, {}, [])

    monkeypatch.setattr(core, "rig", found)


@pytest.fixture
def body(blender, known, scan, lender):
    """The scan, with a key and a group of the user's."""
    obj = add_object("Body", scan, lender.faces)
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Smile")
    obj.vertex_groups.new(name="Mine").add([0, 1], 0.5, "REPLACE")
    return obj


def add_object(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], np.asarray(faces).tolist() if len(faces) else [])
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def flat(collection, attribute, width):
    data = np.empty(len(collection) * width, dtype=np.float32)
    collection.foreach_get(attribute, data)
    return data.tobytes()


def snapshot(obj):
    """Record everything of an object's mesh that may matter to a user, bit for bit."""
    mesh, keys = obj.data, obj.data.shape_keys
    colours = mesh.color_attributes
    return {
        "mode": obj.mode,
        "vertices": flat(mesh.vertices, "co", 3),
        "edges": [tuple(edge.vertices) for edge in mesh.edges],
        "polygons": [tuple(polygon.vertices) for polygon in mesh.polygons],
        "chosen": [vertex.select for vertex in mesh.vertices],
        "keys": keys and {
            key.name: (flat(key.data, "co", 3), key.value, key.mute, key.slider_min, key.slider_max, key.vertex_group,
                       key.relative_key.name, key.lock_shape)
            for key in keys.key_blocks
        },
        "active key": obj.active_shape_key and obj.active_shape_key.name,
        "groups": [(group.name, group.index, group.lock_weight) for group in obj.vertex_groups],
        "active group": obj.vertex_groups.active and obj.vertex_groups.active.name,
        "weights": [sorted((part.group, part.weight) for part in vertex.groups) for vertex in mesh.vertices],
        "colours": {each.name: (each.data_type, each.domain, flat(each.data, "color", 4)) for each in colours},
        "active colours": colours.active_color and colours.active_color.name,
        "attributes": sorted(each.name for each in mesh.attributes),
        "properties": sorted((name, name == RECORD_PROPERTY or str(plain(value))) for name, value in mesh.items())
        + sorted(obj.keys()),
        "animation": keys and keys.animation_data and [curve.data_path for curve in keys.animation_data.drivers],
        "pinned": obj.show_only_shape_key,
        "materials": [slot and slot.name for slot in mesh.materials],
    }  # fmt: skip


def plain(value):
    """What a property of Blender's holds, without the places in memory that its text would tell."""
    if isinstance(value, list):
        return [plain(each) for each in value]
    return value.to_dict() if hasattr(value, "to_dict") else value


class Layout:
    """A stand-in for Blender's layout that lists what a panel draws."""

    def __init__(self, lines):
        self.lines = lines

    def prop(self, owner, name, **options):
        assert name.startswith("[") or name in owner.bl_rna.properties
        self.lines.append(options.get("text", name))

    def prop_search(self, owner, name, source, collection, **_):
        assert hasattr(source, collection)
        self.prop(owner, name)

    def operator(self, name, text=None, **_):
        assert name.startswith("object.")
        self.lines.append(name if text is None else text)
        return type("Options", (), {})()

    def template_list(self, kind, _, owner, name, *__, **___):
        assert hasattr(bpy.types, kind)
        assert hasattr(owner, name)
        self.lines.append(name)

    def label(self, text="", **_):
        self.lines.append(text)

    def prop_enum(self, owner, name, value, text=""):
        assert value in owner.bl_rna.properties[name].enum_items
        self.lines.append(text)

    def panel(self, name, **_):
        assert name.startswith("canonical_form")
        return self, self

    def progress(self, text="", **_):
        self.lines.append(text)

    def column(self, **_):
        return self

    row = box = grid_flow = column


def drawn(panel):
    """List the texts that a panel draws; none where it is hidden."""
    lines: list[str] = []
    if not hasattr(panel, "poll") or panel.poll(bpy.context):
        panel.draw(type("Self", (), {"layout": Layout(lines)})(), bpy.context)
    return lines
