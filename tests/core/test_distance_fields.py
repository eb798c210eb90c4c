import numpy as np
import pygeodesic.geodesic
import pytest
from scipy.spatial import cKDTree

from addon.core import CancelledError, InvalidSettingsError, TooLargeError, distance_fields
from addon.core.distance_fields import KINDS, distance_field, heat_geodesics
from addon.core.distances.heat import FEWEST, HeatMethod
from addon.core.surface.delaunay import intrinsic_delaunay, refined
from addon.core.surface.triangulation import triangulated
from tests.meshes import pieced, shapes
from tests.meshes.shapes import Mesh


def exact(vertices, faces, sources):
    return pygeodesic.geodesic.PyGeodesicAlgorithmExact(vertices, faces).geodesicDistances(np.array(sources))[0]


@pytest.mark.parametrize("name", ["horse/bind.obj", "man/walk1_04.obj"])
@pytest.mark.parametrize(("kind", "most"), [("heat", 0.025), ("fast_marching", 0.025)])
def test_geodesics_on_real_meshes_agree_with_exact_ones(real_mesh, name, kind, most):
    vertices, faces = real_mesh(name)
    true = exact(vertices, faces, [100, 2000])
    measured = distance_field(vertices, faces, [100, 2000], kind)
    assert np.abs(measured - true).mean() < most * true.mean()


@pytest.fixture(scope="module")
def large(figure):
    """A mesh of 8,000 vertices, and exact distances on it from some lists of sources."""
    vertices, faces = shapes.midpoints(*figure)
    sources = ([100], [7, 4000], list(range(0, 8000, 400)))
    return vertices, faces, [(each, exact(vertices, faces, each)) for each in sources]


@pytest.mark.parametrize("size", [None, (4000, 3000)])
def test_a_large_mesh_is_measured_on_a_coarse_one_and_as_accurately(size, large, monkeypatch):
    vertices, faces, fields = large
    if size is not None:
        monkeypatch.setattr("addon.core.distance_fields._WHOLE", size[0])
        monkeypatch.setattr("addon.core.distance_fields._COARSE", size[1])
    said: list[str] = []
    for sources, true in fields:
        measured = distance_field(vertices, faces, sources, "heat", warned=said.append)
        assert (measured[sources] == 0).all()
        assert np.abs(measured - true).mean() < (0.025 if len(sources) < 16 else 0.1) * true.mean()
    assert said == []
    one = heat_geodesics(vertices, faces, [100])[:, 0]
    np.testing.assert_allclose(one, distance_field(vertices, faces, [100]), atol=1e-9 * one.max())


@pytest.mark.parametrize("whole", [30_000, 1500])
@pytest.mark.parametrize("angle", [0.2, 0.8, 1.6, 2.5])
def test_a_selection_is_measured_from_its_border(whole, angle, monkeypatch):
    monkeypatch.setattr("addon.core.distance_fields._WHOLE", whole)
    monkeypatch.setattr("addon.core.distance_fields._COARSE", min(whole, 1400))
    vertices, faces = shapes.sphere(5)
    polar = np.arccos(np.clip(vertices[:, 2], -1, 1))
    sources = np.flatnonzero(polar <= angle)
    measured = distance_field(vertices, faces, sources, "heat")
    true = 2 * np.arcsin(np.clip(cKDTree(vertices[sources]).query(vertices)[0] / 2, 0, 1))
    assert (measured[sources] == 0).all()
    assert np.abs(measured - true).mean() < 0.0075  # edges are .035 long; with those inside as sources .008 to .013


def test_a_whole_part_of_a_body_is_a_source():
    made = pieced.character()[2]
    vertices, faces = made.vertices, made.faces
    told: list[str] = []
    trunk = np.flatnonzero(vertices[:, 2] <= np.sort(vertices[:, 2])[3])
    sources = np.union1d(made.pieces["hand"], trunk)
    measured = distance_field(vertices, faces, sources, "heat", warned=told.append)
    marched = distance_field(vertices, faces, sources, "fast_marching", warned=told.append)
    assert not any("spikes" in sentence for sentence in told)
    assert np.abs(measured - marched).max() < 0.03 * np.ptp(vertices, axis=0).max()


def test_a_selection_of_everything_is_at_no_distance():
    vertices, faces = shapes.sphere(3)
    assert (distance_field(vertices, faces, np.arange(len(vertices)), "heat") == 0).all()


def test_many_sources_are_measured_from_together(figure):
    vertices, faces = figure
    sources = np.flatnonzero(vertices[:, 2] < np.quantile(vertices[:, 2], 0.1))
    true = exact(vertices, faces, sources)
    measured = distance_field(vertices, faces, sources, "heat")
    assert (measured[sources] == 0).all()
    assert np.abs(measured - true).mean() < 0.1 * true.mean()


@pytest.mark.parametrize("kind", KINDS)
def test_fields_vanish_at_the_source_and_scale(kind, figure, rotation):
    vertices, faces = figure
    here = distance_field(vertices, faces, [7], kind)
    assert here[7] == pytest.approx(0, abs=1e-6 * here.max())
    assert (np.delete(here, 7) > 0).all()
    there = distance_field(5.0 * vertices @ rotation + 3, faces, [7], kind)
    unit = 1.0 if kind == "commute_time" else 5.0
    np.testing.assert_allclose(there, unit * here, atol=1e-5 * there.max())


@pytest.mark.parametrize("kind", ["biharmonic", "commute_time"])
def test_spectral_fields_on_all_vertices_agree_with_a_dense_decomposition(kind, figure):
    from scipy.linalg import eigh

    from addon.core.surface.laplacian import mass, stiffness

    vertices, faces = shapes.sphere(2)
    vertices = vertices * [1.0, 1.3, 0.8]
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    values, vectors = eigh(stiffness(surface).toarray(), np.diag(mass(surface)))
    power = 2 if kind == "biharmonic" else 1
    dense = (((vectors[:, 1:] - vectors[5, 1:]) ** 2) / values[1:] ** power).sum(axis=1) ** 0.5
    np.testing.assert_allclose(distance_field(vertices, faces, [5], kind), dense, atol=1e-7 * dense.max())


def test_what_makes_no_sense_is_refused(figure):
    vertices, faces = figure
    with pytest.raises(InvalidSettingsError, match="kind"):
        distance_field(vertices, faces, [0], "euclidean")
    with pytest.raises(InvalidSettingsError, match="at least one"):
        distance_field(vertices, faces, [])
    with pytest.raises(InvalidSettingsError, match="at most"):
        distance_field(vertices, faces, np.arange(1500), "biharmonic")
    with pytest.raises(CancelledError):
        distance_field(vertices, faces, [0], cancelled=lambda: True)


def test_what_was_repaired_is_told(figure):
    vertices, faces = figure
    faces = np.vstack([faces, faces[:1]])
    said: list[str] = []
    distance_field(vertices, faces, [0], warned=said.append)
    assert len(said) == 1
    assert said[0].startswith("1 face was left out")
    with pytest.warns(UserWarning, match="1 face was left out"):
        distance_field(vertices, faces, [0])
    with pytest.warns(UserWarning, match="1 face was left out"):
        heat_geodesics(vertices, faces, [0])


def test_a_fallback_on_a_piece_is_told(monkeypatch):
    monkeypatch.setattr(HeatMethod, "_from_sparks", lambda self, source, column: np.full((9, len(source)), np.nan))
    said: list[str] = []
    heat_geodesics(*shapes.grid(3, 3), [0], warned=said.append)
    assert "were measured along edges" in " ".join(said)


def test_distances_beside_spikes_stay_possible_and_it_is_told():
    vertices, faces = shapes.grid(40, 3)
    vertices = vertices.copy()
    vertices[7, 2] += 3
    exact_ones = exact(vertices, faces, [0])
    said: list[str] = []
    field = distance_field(vertices, faces, [0], warned=said.append)
    assert "The heat method is inaccurate beside spikes" in said[0]
    np.testing.assert_array_equal(heat_geodesics(vertices, faces, [0], warned=lambda _: None)[:, 0], field)
    assert (field >= np.linalg.norm(vertices - vertices[0], axis=1) - 1e-12).all()
    assert (field >= exact_ones * 0.9 - 0.05 * exact_ones.max()).all()


def test_many_sources_are_done_in_blocks(monkeypatch, figure: Mesh):
    whole = heat_geodesics(*figure, np.arange(0, 2000, 40))
    monkeypatch.setattr("addon.core.distances.heat._AT_ONCE", 30_000)
    np.testing.assert_allclose(heat_geodesics(*figure, np.arange(0, 2000, 40)), whole, atol=1e-9)


@pytest.mark.parametrize("size", [1e-120, 1e120])
def test_no_size_is_too_small_or_too_large(size):
    vertices, faces = shapes.sphere(2)
    for kind in KINDS:
        unit = 1 if kind == "commute_time" else size
        field = distance_field(size * vertices, faces, [3], kind)
        np.testing.assert_allclose(field / unit, distance_field(vertices, faces, [3], kind), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(
        heat_geodesics(size * vertices, faces, [3]) / size, heat_geodesics(vertices, faces, [3]), rtol=1e-6, atol=1e-9
    )


def test_small_meshes_are_refined_until_distances_are_right(monkeypatch):
    monkeypatch.setattr("addon.core.distance_fields._possible", lambda field, *_: field)
    vertices, faces = np.eye(3), np.array([[0, 1, 2]])
    error = np.abs(heat_geodesics(vertices, faces, [0])[:, 0] - np.linalg.norm(vertices - vertices[0], axis=1)).max()
    fine = refined(triangulated(vertices, faces), FEWEST)  # 400 vertices, as inside patches
    plain = HeatMethod(fine, count=3).distances([0])[:, 0]
    assert error < 0.7 * np.abs(plain - np.linalg.norm(vertices - vertices[0], axis=1)).max()


@pytest.mark.parametrize("kind", ["biharmonic", "commute_time"])
def test_a_mesh_that_cannot_be_made_coarse_is_told_or_refused(kind, monkeypatch):
    monkeypatch.setattr("addon.core.distance_fields._WORKED_ON", 300)
    vertices, faces = fans(850)
    said: list[str] = []
    assert np.isfinite(distance_field(vertices, faces, [0], kind, warned=said.append)).all()
    assert "hard to reduce" in said[0]
    with pytest.raises(TooLargeError, match="All pairs of points need it"):
        distance_field(vertices, faces, [0], kind, memory_limit=0.11)


def fans(count):
    """Triangles in a row that touch at their corners only."""
    x = np.arange(count)[:, None, None]
    corners = np.concatenate([np.broadcast_to([[0, 0, 0], [1, 0, 0], [0.5, 1, 0]], (count, 3, 3)) + x * [1, 0, 0]])
    points, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return points, faces.reshape(-1, 3)


def test_a_single_vertex_may_stand_for_a_list_and_nothing_else():
    mesh = shapes.grid(5, 5)
    np.testing.assert_array_equal(heat_geodesics(*mesh, 3), heat_geodesics(*mesh, [3]))
    for sources in ([[0, 1], [2, 3]], [[0], [1, 2]]):
        for measure in (heat_geodesics, distance_field):
            with pytest.raises(InvalidSettingsError, match="must be a list"):
                measure(*mesh, sources)


def test_every_kind_has_its_way_of_being_measured():
    assert set(distance_fields._FIELDS) == set(KINDS)
