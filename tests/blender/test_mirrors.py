"""Half a mesh under a mirror modifier: its form is that of the whole, and stays on the mirror."""

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_evaluated, read_mesh
from addon.blender.records.record import require_record
from addon.core.mesh.connectivity import component_labels
from addon.core.mesh.edges import vertex_pairs
from addon.interface.overlay import shown_points
from tests.meshes import shapes

from .conftest import QUICK, add_object, snapshot

KEY = "Canonical Form"


def half_body():
    """Half of a body with a head, an arm and a leg, cut where x = 0."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 13)
    rings, size = [], 40
    for step in range(size):
        z = 3.0 * step / (size - 1)
        radius = 0.5 + 0.15 * np.cos(4 * z)
        rings.append(np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(13, z)]))
    vertices = np.concatenate(rings)
    vertices[np.abs(vertices[:, 0]) < 1e-9, 0] = 0.0
    arm = (np.abs(vertices[:, 2] - 2.2) < 0.25) & (vertices[:, 0] > 0.35)
    vertices[arm, 0] *= 4.0
    vertices[arm, 1] += 0.15 * (vertices[arm, 0] - 1.4) ** 2  # bent
    corners = [13 * ring + at for ring in range(size - 1) for at in range(12)]
    faces = np.array([[i, i + a, i + b] for i in corners for a, b in ((1, 14), (14, 13))])
    return vertices, faces


@pytest.fixture
def half(blender):
    obj = add_object("Half", *half_body())
    obj.modifiers.new("Mirror", "MIRROR")
    return obj


def form_of(obj):
    return np.array([point.co for point in obj.data.shape_keys.key_blocks[KEY].data])


def on_mirror(obj):
    return read_mesh(obj.data)[0][:, 0] == 0


def run(**options):
    return bpy.ops.object.canonical_form(**{**QUICK, **options})


def test_the_border_stays_on_the_mirror_and_the_whole_is_closed(half):
    before = snapshot(half)
    run()
    assert on_mirror(half).sum() == 80
    assert not form_of(half)[on_mirror(half), 0].any()
    vertices, faces = read_evaluated(half)
    assert component_labels(len(vertices), vertex_pairs(faces)).max() == 0
    assert not [each for each in require_record(half.data).report.warnings if "modifiers" in each]
    bpy.ops.object.canonical_form_clear()
    assert snapshot(half) == before


def test_the_form_is_that_of_the_whole(half):
    run(quality="draft", max_iterations=100)
    mirrored = read_evaluated(half)[0]
    record = require_record(half.data)
    bpy.ops.object.canonical_form_clear()
    bpy.ops.object.modifier_apply(modifier="Mirror")
    run(quality="draft", max_iterations=100)
    whole = form_of(half)
    spread = np.ptp(whole, axis=0).max()
    assert np.abs(mirrored - whole).max() < 0.05 * spread  # the whole by itself is not quite symmetric
    count = len(require_record(half.data).report.feature_points)
    assert len(record.report.feature_points) <= count
    assert min(record.report.feature_points) >= 0
    assert min(record.report.patch_sizes) > 0


def test_limbs_and_in_betweens_stay_on_the_mirror(half):
    run()
    bpy.ops.object.canonical_form_limb(patch=1, only=True)
    assert not form_of(half)[on_mirror(half), 0].any()
    bpy.ops.object.canonical_form_limb(patch=0)
    bpy.ops.object.canonical_form_in_betweens(count=1)
    key = half.data.shape_keys.key_blocks["Canonical Form 50%"]
    assert not np.array([point.co for point in key.data])[on_mirror(half), 0].any()


def test_a_feature_point_has_its_image(half):
    run(feature_points="0, 300")
    report = require_record(half.data).report
    assert report.feature_points == [0, 300]
    assert sum(report.patch_sizes) == len(half.data.vertices)


def test_a_mirrored_half_beside_another_object(half):
    ball, faces = shapes.sphere(2)
    other = add_object("Hat", 0.3 * ball, faces)
    other.location.z = 3.2
    half.select_set(True)
    bpy.context.view_layer.update()
    run()
    assert require_record(half.data).report.objects == ["Hat", "Half"]
    assert not form_of(half)[on_mirror(half), 0].any()


@pytest.mark.parametrize("change", ["mirror_object", "use_bisect_axis"])
def test_other_mirrors_are_warned_about(half, change):
    modifier = half.modifiers["Mirror"]
    if change == "mirror_object":
        modifier.mirror_object = bpy.data.objects.new("Centre", None)
    else:
        modifier.use_bisect_axis[0] = True
    run()
    assert any("add to the mesh or hide" in each for each in require_record(half.data).report.warnings)


def test_labels_are_on_the_form(half):
    run()
    labels = shown_points([half], bpy.context.evaluated_depsgraph_get())
    shown = read_evaluated(half)[0]
    assert len(labels) == len(require_record(half.data).report.feature_points)
    for point in labels:
        assert np.linalg.norm(shown - np.array(point.place), axis=1).min() < 1e-5
