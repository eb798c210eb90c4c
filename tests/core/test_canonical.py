import inspect
import pkgutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import addon.core
from addon.core import CancelledError, InvalidMeshError, InvalidSettingsError, Settings, TooLargeError, canonical_form
from addon.core.distance_fields import heat_geodesics
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area, vertex_areas
from addon.core.results import CanonicalForm
from addon.core.surface.triangulation import corner_lengths, face_areas
from tests.meshes import shapes
from tests.meshes.shapes import Mesh


@pytest.fixture(scope="module")
def form(figure):
    return canonical_form(*figure)


def differs(form, reference, scale=1.0):
    """Largest distance after rigid alignment, as a share of the diameter."""
    turn, shift = rigid_fit(form / scale, reference)
    return np.linalg.norm(form / scale @ turn + shift - reference, axis=1).max() / np.linalg.norm(
        np.ptp(reference, axis=0)
    )


def test_the_contract(figure, form):
    vertices, faces = figure
    assert isinstance(form, CanonicalForm)
    assert form.vertices.shape == vertices.shape
    assert surface_area(form.vertices, faces) == pytest.approx(surface_area(vertices, faces), rel=1e-9)
    assert len(form.feature_points) == 5
    assert form.patches.shape == form.adf.shape == (len(vertices),)
    assert set(form.patches) == set(range(5))
    np.testing.assert_array_equal(form.patches[form.feature_points], np.arange(5))
    assert (len(form.stress), form.pair_count, form.pair_reduction) == (0, 0, 0.0)  # it is no minimum of one stress
    assert [told.kind for told in form.warnings] == ["one_pair"]  # among the five limbs of the figure
    assert sum(form.timings.values()) > 0


def test_it_lies_where_the_input_lies(figure, form):
    vertices, faces = figure
    weights = vertex_areas(vertices, faces)
    turn, shift = rigid_fit(form.vertices, vertices, weights)
    np.testing.assert_allclose(turn, np.eye(3), atol=1e-6)
    np.testing.assert_allclose(shift, 0, atol=1e-6)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_rigid_motion_and_scale_do_not_change_the_form(figure, form, rotation, scale):
    vertices, faces = figure
    moved = canonical_form(scale * (vertices @ rotation + [10.0, -3.0, 5.0]), faces)
    np.testing.assert_array_equal(moved.feature_points, form.feature_points)
    np.testing.assert_array_equal(moved.patches, form.patches)
    assert differs(moved.vertices, form.vertices, scale) < 1e-6


def test_rounding_does_not_change_the_form_of_a_symmetric_mesh(real_mesh, rotation):
    vertices, faces = real_mesh("man/rest.obj")
    form = canonical_form(vertices, faces)
    assert differs(canonical_form(7.3 * (vertices @ rotation), faces).vertices, form.vertices, 7.3) < 1e-6


def test_renumbering_does_not_change_the_form(figure, form):
    vertices, faces, old = shapes.permuted(*figure)
    renumbered = canonical_form(vertices, faces)
    assert differs(renumbered.vertices, form.vertices[old]) < 1e-3
    np.testing.assert_array_equal(old[renumbered.feature_points], form.feature_points)


def test_a_mirrored_mesh_has_the_mirrored_form(figure, form):
    vertices, faces = figure
    mirrored = canonical_form(vertices * [-1.0, 1.0, 1.0], faces[:, ::-1])
    assert differs(mirrored.vertices * [-1.0, 1.0, 1.0], form.vertices) < 1e-3


def test_two_runs_give_the_same_bits(figure, form):
    np.testing.assert_array_equal(canonical_form(*figure).vertices, form.vertices)


def test_real_poses_of_one_shape_have_the_same_features(real_mesh: Callable[[str], Mesh]):
    names = ("bind", "horse_gallop_f00", "horse_death_02_f22")
    forms = [canonical_form(*real_mesh(f"horse/{name}.obj")) for name in names]
    rest = heat_geodesics(*real_mesh("horse/bind.obj"), forms[0].feature_points)
    for form in forms:
        assert len(form.feature_points) == 6
        assert rest[form.feature_points].min(axis=1).max() < 0.05 * rest.max()


def test_the_pose_goes_out(real_mesh):
    meshes = [real_mesh(f"horse/{name}.obj") for name in ("bind", "horse_death_02_f22")]
    forms = [canonical_form(*mesh).vertices for mesh in meshes]

    def apart(one, two):
        turn, shift = rigid_fit(one, two)
        return np.sqrt((((one @ turn + shift) - two) ** 2).sum(axis=1).mean())

    assert apart(*forms) < 0.65 * apart(meshes[0][0], meshes[1][0])


@pytest.mark.parametrize(
    ("method", "stages"),
    [
        ("straight", ("Spectrum", "Feature points", "Landmarks", "Layout", "Push", "Detail")),
        ("local_features", ("Distances", "Landmarks", "Layout", "Embedding", "Detail")),
    ],
)
def test_every_long_stage_asks_often_whether_to_stop(figure: Mesh, method, stages):
    asked: Counter[str] = Counter()
    stage = [""]

    def cancelled():
        asked[stage[0]] += 1
        return False

    settings = Settings(method=method)
    canonical_form(*figure, settings, progress=lambda _, name: stage.__setitem__(0, name), cancelled=cancelled)
    for name in stages:
        assert asked[name] > 5, name  # the seconds between two questions are measured by the benchmark


def test_progress_rises_to_one_through_named_stages(figure: Mesh):
    seen = []
    form = canonical_form(*figure, progress=lambda done, stage: seen.append((done, stage)))
    done = [fraction for fraction, _ in seen]
    assert done == sorted(done)
    assert done[0] >= 0
    assert done[-1] == 1
    assert list(dict.fromkeys(stage for _, stage in seen)) == list(form.timings)


@pytest.mark.parametrize("stop_at", [1, 20, 60, 150])
def test_cancel_stops_the_run(figure, stop_at):
    asked = iter(range(10**9))
    with pytest.raises(CancelledError):
        canonical_form(*figure, cancelled=lambda: next(asked) >= stop_at)


def test_features_by_hand(figure):
    vertices, faces = figure
    form = canonical_form(vertices, faces, Settings(feature_points=[7, 900, 1500]))
    np.testing.assert_array_equal(form.feature_points, [7, 900, 1500])
    assert set(form.patches) == {0, 1, 2}
    refused: list[Any] = [[], [1, 1], [-1], [len(vertices)], [0.5]]
    for wrong in refused:
        with pytest.raises(InvalidSettingsError):
            canonical_form(vertices, faces, Settings(feature_points=wrong))


def test_too_large_a_mesh_is_refused_before_the_memory_is_spent(sphere: Mesh):
    with pytest.raises(TooLargeError, match=r"GB.*reduce the mesh to about .* vertices"):
        canonical_form(*sphere, Settings(memory_limit=0.05, quality="full", method="local_features"))
    with pytest.raises(TooLargeError, match=r"GB.*Reduce the [\d,]+ vertices"):
        canonical_form(*sphere, Settings(memory_limit=0.05))


def test_a_sphere_is_its_own_form():
    vertices, faces = shapes.sphere(3)
    form = canonical_form(vertices, faces, Settings(prominence=0.5))
    assert len(form.feature_points) == 1
    radius = np.linalg.norm(form.vertices - form.vertices.mean(axis=0), axis=1)
    assert np.ptp(radius) < 0.5 * radius.mean()  # geodesics of a sphere fit no sphere exactly


def test_tiny_meshes_work():
    tetrahedron = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    assert np.isfinite(canonical_form(tetrahedron, faces).vertices).all()
    assert np.isfinite(canonical_form(np.eye(3), [[0, 1, 2]]).vertices).all()


def test_lists_and_single_precision_are_taken(figure):
    vertices, faces = figure
    form = canonical_form(vertices.astype(np.float32), faces.astype(np.int32))
    assert form.vertices.dtype == np.float64
    with pytest.raises(InvalidMeshError):
        canonical_form([], [])


def test_zero_area_triangles_do_not_break_it(figure):
    vertices, faces = figure
    collapsed = vertices.copy()
    collapsed[faces[10, 0]] = collapsed[faces[10, 1]]
    assert (face_areas(corner_lengths(collapsed, faces)) == 0).any()
    form = canonical_form(collapsed, faces)
    assert np.isfinite(form.vertices).all()


def test_the_core_knows_no_blender():
    code = "import sys, addon.core; sys.exit('bpy' in sys.modules or any(m.startswith('scipy') for m in sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_every_public_function_is_documented():
    for found in pkgutil.iter_modules(addon.core.__path__):
        module = __import__(f"addon.core.{found.name}", fromlist=["_"])
        for name, thing in vars(module).items():
            if name[0] != "_" and inspect.isfunction(thing) and thing.__module__ == module.__name__:
                assert "Returns" in (thing.__doc__ or "") or "None" in str(thing.__annotations__.get("return")), name
                if inspect.signature(thing).parameters:
                    assert "Parameters" in (thing.__doc__ or ""), name


def test_draft_normal_and_full_agree(figure):
    vertices, faces = figure
    forms = [canonical_form(vertices, faces, Settings(quality=quality)) for quality in ("draft", "normal", "full")]
    for form in forms[:2]:
        assert len(form.feature_points) == len(forms[2].feature_points)
        turn, shift = rigid_fit(form.vertices, forms[2].vertices)
        apart = np.sqrt(((form.vertices @ turn + shift - forms[2].vertices) ** 2).sum(axis=1).mean())
        assert apart < 0.06 * np.sqrt(surface_area(vertices, faces))


def test_a_result_shows_sizes_in_place_of_arrays(figure):
    form = canonical_form(figure[0], figure[1], Settings(quality="draft"))
    assert repr(form).startswith(f"<CanonicalForm: vertices {form.vertices.shape}, faces {form.faces.shape}, ")
    assert len(repr(form)) < 200
