import numpy as np
import pygeodesic.geodesic
import pytest

from addon.core import SolverError
from addon.core.distance_fields import heat_geodesics
from addon.core.distances import heat
from addon.core.distances.heat import HeatMethod
from addon.core.run.monitor import Monitor
from addon.core.surface.delaunay import intrinsic_delaunay, refined
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def exact(vertices, faces, sources):
    solver = pygeodesic.geodesic.PyGeodesicAlgorithmExact(vertices, faces)
    return np.stack([solver.geodesicDistances(np.array([source]))[0] for source in sources], axis=1)


def mean_relative_error(measured, true):
    return (np.abs(measured - true)[true > 0] / true[true > 0]).mean()


def test_distances_on_a_plane_are_euclidean():
    vertices, faces = shapes.grid(41, 31, 4.0, 3.0)
    sources = [0, 640, 1270]
    true = np.linalg.norm(vertices[:, None] - vertices[sources], axis=2)
    measured = heat_geodesics(vertices, faces, sources)
    assert mean_relative_error(measured, true) < 0.015
    assert (measured[sources, range(3)] == 0).all()


def test_distances_on_a_sphere_are_arcs(sphere):
    vertices, faces = sphere
    true = np.arccos(np.clip(vertices @ vertices[[0, 100]].T, -1, 1))
    assert mean_relative_error(heat_geodesics(vertices, faces, [0, 100]), true) < 0.015


def test_distances_on_a_tube_go_around_it():
    vertices, faces = shapes.cylinder(60, 41)
    angle = np.abs(np.angle(np.exp(1j * (np.arctan2(vertices[:, 1], vertices[:, 0])))))
    source = int(np.argmin(angle + np.abs(vertices[:, 2] - 2)))
    true = np.hypot(angle, vertices[:, 2] - vertices[source, 2])
    assert mean_relative_error(heat_geodesics(vertices, faces, [source])[:, 0], true) < 0.015


@pytest.mark.parametrize("name", ["horse/horse_death_02_f22.obj", "bear/bear_walk_f00.obj", "man/benchmark_00.obj"])
def test_distances_on_real_meshes_agree_with_exact_ones(real_mesh, name):
    vertices, faces = real_mesh(name)
    sources = np.random.default_rng(7).choice(len(vertices), 20, replace=False)
    measured = heat_geodesics(vertices, faces, sources)
    assert mean_relative_error(measured, exact(vertices, faces, sources)) < 0.02
    off_diagonal = np.ones_like(measured, dtype=bool)
    off_diagonal[sources, np.arange(len(sources))] = False
    assert measured[off_diagonal].min() > 0


def test_needles_do_not_break_it(figure):
    vertices, faces = figure
    vertices = vertices * [1.0, 40.0, 1.0]  # edge ratios of 1 to 40
    measured = heat_geodesics(vertices, faces, [0, 50])
    assert mean_relative_error(measured, exact(vertices, faces, [0, 50])) < 0.1


def test_a_long_thin_strip_does_not_run_out_of_heat():
    vertices, faces = shapes.grid(3000, 2, 3000.0, 1.0)
    measured = heat_geodesics(vertices, faces, [0])[:3000, 0]
    np.testing.assert_allclose(measured[10:], vertices[10:3000, 0], rtol=0.05)


def test_it_does_not_depend_on_scale_or_numbering(figure):
    vertices, faces = figure
    plain = heat_geodesics(vertices, faces, [3])[:, 0]
    np.testing.assert_allclose(heat_geodesics(vertices * 1e3, faces, [3])[:, 0], plain * 1e3, rtol=1e-8, atol=1e-6)
    moved, renumbered, old = shapes.permuted(vertices, faces)
    source = int(np.flatnonzero(old == 3)[0])
    np.testing.assert_allclose(heat_geodesics(moved, renumbered, [source])[:, 0], plain[old], atol=1e-8)


def test_refinement_lowers_the_error(figure):
    vertices, faces = figure
    true = exact(vertices, faces, [0])
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    plain, fine = HeatMethod(surface), HeatMethod(refined(surface, 0), count=len(vertices))
    errors = [mean_relative_error(heat.distances([0]), true) for heat in (plain, fine)]
    assert errors[1] < 0.85 * errors[0]


def test_a_surface_in_two_parts_is_refused():
    vertices, faces = shapes.sphere(1)
    both = triangulated(np.vstack([vertices, vertices + 5]), np.vstack([faces, faces + len(vertices)]))
    with pytest.raises(SolverError, match="loose parts"):
        HeatMethod(both)


def test_a_connected_surface_that_heat_does_not_cross_has_distances_along_its_edges(monkeypatch):
    monkeypatch.setattr(heat, "_LONGER", 0)  # as where rounding leaves edges without weight
    vertices, faces = shapes.sphere(1)
    monitor = Monitor()
    distances = HeatMethod(triangulated(vertices, faces), monitor=monitor).distances([0])[:, 0]
    assert [each.kind for each in monitor.warnings] == ["heat_fallback"]
    assert (distances >= exact(vertices, faces, [0])[:, 0] - 1e-9).all()
