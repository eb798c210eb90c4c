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
from addon.core.distances.heat import HeatMethod
from addon.core.distances.patch_geodesics import all_geodesics
from addon.core.distances.spectral import GreensFunction, commute_time_squared
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.geometry import surface_area, vertex_areas
from addon.core.results import CanonicalForm
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from addon.core.surface.triangulation import corner_lengths, face_areas, triangulated
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
    assert (np.diff(form.stress) <= 1e-12 * form.stress[:-1]).all()
    assert form.pair_reduction == 1 - form.pair_count / len(vertices) ** 2
    assert 0.8 < form.pair_reduction < 0.99
    assert form.warnings == []
    assert sum(form.timings.values()) > 0


def test_the_default_is_as_good_as_converged(figure: Mesh, form):
    long = canonical_form(*figure, Settings(tolerance=1e-8, max_iterations=2000))
    assert len(long.stress) > len(form.stress)
    assert form.stress[-1] < 1.03 * long.stress[-1]


def test_it_lies_where_the_input_lies(figure, form):
    vertices, faces = figure
    weights = vertex_areas(vertices, faces)
    turn, shift = rigid_fit(form.vertices, vertices, weights)
    np.testing.assert_allclose(turn, np.eye(3), atol=1e-6)
    np.testing.assert_allclose(shift, 0, atol=1e-6)


def test_stress_is_equation_10_pair_by_pair():
    vertices, faces = shapes.figure(13)
    points = vertices - vertices.mean(axis=0)
    points /= np.sqrt(surface_area(points, faces))
    settings = Settings(max_iterations=0, start="input", eigenpairs=40, quality="full", smoothing=0, preserve_detail=0)
    form = canonical_form(vertices, faces, settings)
    surface = intrinsic_delaunay(triangulated(points, faces))
    L, M = stiffness(surface), mass(surface)
    spectrum = compute_spectrum(L, M, len(M))  # all there are
    features = form.feature_points
    total, held = 0.0, 0.0
    for index in range(len(features)):
        closed = faces[(form.patches[faces] == index).any(axis=1)]
        members, corners = np.unique(closed, return_inverse=True)
        delta = all_geodesics(triangulated(points[members], corners.reshape(-1, 3)))
        c2 = commute_time_squared(spectrum, members, members)
        for i in range(len(members)):
            for j in range(i + 1, len(members)):
                weight = c2[i, j] / delta[i, j] ** 2
                apart = np.sqrt(((points[members[i]] - points[members[j]]) ** 2).sum())
                total += weight * (delta[i, j] - apart) ** 2
                held += weight * (int(members[i] in features) + int(members[j] in features))
    between = HeatMethod(surface).distances(features)[features]
    biharmonic = GreensFunction(L, M).biharmonic_distances(features)
    s = (biharmonic * between).sum() / (biharmonic**2).sum()
    heat = form.adf[features]
    pairs = [(i, j) for i in range(len(features)) for j in range(i + 1, len(features))]
    factor = 0.03 * held / sum(heat[i] + heat[j] for i, j in pairs)
    for i, j in pairs:
        apart = np.linalg.norm(points[features[i]] - points[features[j]])
        total += factor * (heat[i] + heat[j]) / 2 * (s * biharmonic[i, j] - apart) ** 2
    assert form.stress[0] == pytest.approx(total, rel=1e-9)


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
    forms = [canonical_form(*real_mesh(f"horse/{name}.obj"), Settings(max_iterations=2)) for name in names]
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


def test_progress_rises_to_one_through_named_stages(figure: Mesh):
    seen = []
    form = canonical_form(*figure, Settings(max_iterations=10), progress=lambda done, stage: seen.append((done, stage)))
    done = [fraction for fraction, _ in seen]
    assert done == sorted(done)
    assert done[0] >= 0
    assert done[-1] == 1
    assert list(dict.fromkeys(stage for _, stage in seen)) == list(form.timings)


def test_every_long_stage_asks_often_whether_to_stop(figure: Mesh):
    asked: Counter[str] = Counter()
    stage = [""]

    def cancelled():
        asked[stage[0]] += 1
        return False

    canonical_form(
        *figure, Settings(max_iterations=5), progress=lambda _, name: stage.__setitem__(0, name), cancelled=cancelled
    )
    for name in ("Spectrum", "Feature points", "Distances", "Landmarks", "Start", "Factorisation", "Embedding"):
        assert asked[name] > 5, name  # the seconds between two questions are measured by the benchmark


@pytest.mark.parametrize("stop_at", [1, 20, 60, 150])
def test_cancel_stops_the_run(figure, stop_at):
    asked = iter(range(10**9))
    with pytest.raises(CancelledError):
        canonical_form(*figure, cancelled=lambda: next(asked) >= stop_at)


def test_features_by_hand(figure):
    vertices, faces = figure
    form = canonical_form(vertices, faces, Settings(feature_points=[7, 900, 1500], max_iterations=3))
    np.testing.assert_array_equal(form.feature_points, [7, 900, 1500])
    assert set(form.patches) == {0, 1, 2}
    refused: list[Any] = [[], [1, 1], [-1], [len(vertices)], [0.5]]
    for wrong in refused:
        with pytest.raises(InvalidSettingsError):
            canonical_form(vertices, faces, Settings(feature_points=wrong))


def test_starting_from_the_input_keeps_more_of_the_pose(figure, form):
    vertices, faces = figure
    kept = canonical_form(vertices, faces, Settings(start="input"))
    assert differs(kept.vertices, vertices) < differs(form.vertices, vertices)


def test_too_few_iterations_are_reported(figure: Mesh):
    assert "before it converged" in canonical_form(*figure, Settings(max_iterations=2)).warnings[0]


def test_too_large_a_mesh_is_refused_before_the_memory_is_spent(sphere: Mesh):
    with pytest.raises(TooLargeError, match=r"GB.*reduce the mesh to about .* vertices"):
        canonical_form(*sphere, Settings(memory_limit=0.05, quality="full"))
    with pytest.raises(TooLargeError, match=r"GB.*Reduce the mesh"):
        canonical_form(*sphere, Settings(memory_limit=0.05))


def test_a_sphere_is_its_own_form():
    vertices, faces = shapes.sphere(3)
    form = canonical_form(vertices, faces, Settings(prominence=0.5))
    assert len(form.feature_points) == 1
    radius = np.linalg.norm(form.vertices - form.vertices.mean(axis=0), axis=1)
    assert np.ptp(radius) < 0.5 * radius.mean()  # geodesics of a sphere fit no sphere exactly


def test_a_bent_sheet_is_unrolled():
    vertices, faces = shapes.grid(33, 17, 2.0, 1.0)
    rolled = np.column_stack([np.cos(2 * vertices[:, 0]), np.sin(2 * vertices[:, 0]), 2 * vertices[:, 1]]) / 2
    form = canonical_form(
        rolled,
        faces,
        Settings(
            quality="full", feature_points=[280], smoothing=0, preserve_detail=0, arrangement_share=0.03, tolerance=1e-5
        ),
    )
    centred = form.vertices - form.vertices.mean(axis=0)
    assert np.ptp(centred @ np.linalg.svd(centred, full_matrices=False)[2][2]) < 0.05
    stretch = edge_stretch(rolled, form.vertices, faces)
    assert np.abs(stretch / np.median(stretch) - 1).mean() < 0.03


def test_tiny_meshes_work():
    tetrahedron = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    assert np.isfinite(canonical_form(tetrahedron, faces).vertices).all()
    assert np.isfinite(canonical_form(np.eye(3), [[0, 1, 2]]).vertices).all()


def test_lists_and_single_precision_are_taken(figure):
    vertices, faces = figure
    form = canonical_form(vertices.astype(np.float32), faces.astype(np.int32), Settings(max_iterations=1))
    assert form.vertices.dtype == np.float64
    with pytest.raises(InvalidMeshError):
        canonical_form([], [])


def test_zero_area_triangles_do_not_break_it(figure):
    vertices, faces = figure
    collapsed = vertices.copy()
    collapsed[faces[10, 0]] = collapsed[faces[10, 1]]
    assert (face_areas(corner_lengths(collapsed, faces)) == 0).any()
    form = canonical_form(collapsed, faces, Settings(max_iterations=10))
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


def test_a_mesh_that_stays_too_large_is_refused_before_its_pairs_are_made():
    fans = [[0, 1, 2, 3, 4 + i] for i in range(1400)]  # what hangs on edges of many triangles cannot be removed
    faces = np.array([face for a, b, c, d, e in fans for face in ((a, b, e), (b, c, e), (c, d, e), (d, a, e))])
    vertices = np.random.default_rng(0).normal(size=(1404, 3))
    with pytest.raises(TooLargeError, match="Merge vertices by distance"):
        canonical_form(vertices, faces, Settings(quality="draft", memory_limit=0.155))


def test_draft_normal_and_full_agree(figure):
    vertices, faces = figure
    forms = [canonical_form(vertices, faces, Settings(quality=quality)) for quality in ("draft", "normal", "full")]
    for form in forms[:2]:
        assert len(form.feature_points) == len(forms[2].feature_points)
        turn, shift = rigid_fit(form.vertices, forms[2].vertices)
        apart = np.sqrt(((form.vertices @ turn + shift - forms[2].vertices) ** 2).sum(axis=1).mean())
        assert apart < 0.06 * np.sqrt(surface_area(vertices, faces))
    assert forms[0].pair_count < forms[1].pair_count < forms[2].pair_count


def test_a_result_shows_sizes_in_place_of_arrays(figure):
    form = canonical_form(figure[0], figure[1], Settings(quality="draft"))
    assert repr(form).startswith(f"<CanonicalForm: vertices {form.vertices.shape}, faces {form.faces.shape}, ")
    assert len(repr(form)) < 200
