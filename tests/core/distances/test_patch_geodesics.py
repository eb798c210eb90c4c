"""Geodesics between all vertices of a patch."""

import numpy as np
import pytest

from addon.core import CancelledError
from addon.core.distances.heat import HeatMethod
from addon.core.distances.patch_geodesics import all_geodesics, geodesics
from addon.core.run.monitor import Monitor
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def test_all_geodesics_of_a_plane_are_euclidean():
    vertices, faces = shapes.grid(19, 15, 1.8, 1.4)
    true = np.linalg.norm(vertices[:, None] - vertices, axis=2)
    off = np.abs(all_geodesics(triangulated(vertices, faces)) - true)
    assert off.mean() < 0.02 * true.mean()


def test_all_geodesics_are_symmetric_positive_and_nearly_a_metric(figure):
    vertices, faces = figure
    near = np.flatnonzero(vertices[:, 1] < -0.9)
    local = np.full(len(vertices), -1)
    local[near] = np.arange(len(near))
    inside = local[faces[(local[faces] >= 0).all(axis=1)]]
    used, inside = np.unique(inside, return_inverse=True)
    points = vertices[near[used]]
    d = all_geodesics(triangulated(points, inside.reshape(-1, 3)))
    np.testing.assert_array_equal(d, d.T)
    assert (np.diag(d) == 0).all()
    assert d[~np.eye(len(d), dtype=bool)].min() > 0
    straight = np.linalg.norm(points[:, None] - points, axis=2)
    assert (d > 0.85 * straight).mean() > 0.99
    some = np.arange(0, len(d), 7)
    part = d[np.ix_(some, some)]
    violation = part[:, None, :] - part[:, :, None] - part[None, :, :]
    assert violation.max() < 0.05 * d.max()


def test_smoothed_geodesics_are_plain_near_and_positive():
    vertices, faces = shapes.grid(41, 41, 1.0, 1.0)
    plain, smooth = (all_geodesics(triangulated(vertices, faces), smooth=time)[[0, 840]] for time in (None, 0.1))
    true = np.linalg.norm(vertices[[0, 840]][:, None] - vertices[None], axis=2)
    assert (np.abs(plain - true)[true > 0] / true[true > 0]).mean() < 0.03
    assert (smooth[true > 0] > 0).all()
    near = (true > 0) & (true < 0.05)
    assert (np.abs(smooth - true)[near] / true[near]).mean() < 0.15
    assert np.corrcoef(smooth.ravel(), true.ravel())[0, 1] > 0.97


def test_smoothed_geodesics_feel_a_bend_less():
    vertices, faces = shapes.cylinder(14, 47, 0.15, 3.0)
    x, y, z = vertices.T
    bent = np.column_stack([(x + 1) * np.cos(z), y, (x + 1) * np.sin(z)])  # a tube around a circle of radius 1
    change = []
    for time in (None, 0.4):
        one, two = (all_geodesics(triangulated(points, faces), smooth=time) for points in (vertices, bent))
        far = one > 1.0
        change.append(np.abs(two[far] / one[far] - 1).mean())
    assert change[1] < 0.7 * change[0]


def test_all_geodesics_hear_a_cancel(sphere):
    with pytest.raises(CancelledError):
        all_geodesics(triangulated(*sphere), monitor=Monitor(cancelled=lambda: True))


def test_all_geodesics_tell_how_far_they_are(sphere):
    told = []
    monitor = Monitor(lambda fraction, _: told.append(fraction))
    with monitor.stage("Distances"):
        all_geodesics(triangulated(*shapes.sphere(1)), monitor=monitor, done=0.25, share=0.5)
    assert told == pytest.approx([0.0, 0.25 + 0.5 * 32 / 42, 0.75, 1.0])


def test_geodesics_from_some_vertices_are_rows_of_all(figure):
    surface = triangulated(*figure)
    every = all_geodesics(surface, smooth=0.1)
    order = np.random.default_rng(0).permutation(surface.vertex_count)[:300]
    some = geodesics(surface, order[:20], order, smooth=0.1)
    np.testing.assert_allclose(some[:, :20], every[np.ix_(order[:20], order[:20])], atol=1e-9)
    one_way = HeatMethod(intrinsic_delaunay(surface), 0.1).distances(order[:20])[order[20:]].T
    np.testing.assert_allclose(some[:, 20:], one_way, atol=1e-9)
    assert np.abs(some - every[np.ix_(order[:20], order)]).mean() < 0.02 * every.mean()
