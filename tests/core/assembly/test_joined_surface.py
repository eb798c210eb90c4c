"""The working surface of a body of several parts."""

import numpy as np
import pytest

from addon.core.assembly import joined_surface as module
from addon.core.assembly.bodies import bodies_of
from addon.core.mesh.connectivity import component_labels
from addon.core.mesh.edges import vertex_pairs
from addon.core.mesh.geometry import of_unit_area
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor
from addon.core.surface.delaunay import intrinsic_delaunay
from tests.meshes import pieced


@pytest.fixture(scope="module")
def body():
    made = pieced.character()[2]
    return bodies_of(made.vertices, made.faces).bodies[0]


@pytest.fixture(scope="module")
def points(body):
    return of_unit_area(body.points, body.faces)[0]


@pytest.mark.parametrize("target", [None, 600])
def test_it_is_one_surface_whose_bridges_join_the_parts(body, points, target):
    surface = body.working_surface(points, body.faces, target)
    own = len(surface.faces) - len(surface.bridges)
    np.testing.assert_array_equal(surface.faces[own:], surface.bridges)
    part = np.searchsorted([vertices.stop for vertices, _, _ in body.parts], surface.kept, side="right")
    assert (part[surface.faces[:own]] == part[surface.faces[:own, :1]]).all()
    assert all(len(set(each)) == 2 for each in part[surface.bridges])
    count = len(surface.kept)
    assert component_labels(count, vertex_pairs(surface.faces)).max() == 0
    assert component_labels(count, vertex_pairs(surface.faces[:own])).max() == 2
    np.testing.assert_array_equal(surface.points, points[surface.kept])
    assert surface.stuck is False
    lengths = np.linalg.norm(surface.points[surface.bridges[:, 0]] - surface.points[surface.bridges[:, 1]], axis=1)
    assert lengths.max() < (0.1 if target is None else 0.2)
    if target is None:
        assert surface.kept.tolist() == list(range(len(points)))
    else:
        assert 0.9 * target < count < 1.1 * target


def test_fixed_vertices_are_kept(body, points):
    fixed = np.arange(0, len(points), 29)
    surface = body.working_surface(points, body.faces, 600, fixed=fixed)
    assert np.isin(fixed, surface.kept).all()
    assert not np.isin(fixed, body.working_surface(points, body.faces, 600).kept).all()


def test_stages_and_progress_are_told(body, points):
    told = []
    monitor = Monitor(lambda share, stage: told.append((share, stage)))
    body.working_surface(points, body.faces, 600, monitor=monitor)
    assert {stage for _, stage in told} >= {"Coarse mesh", "Triangulation"}


def test_a_surface_that_must_keep_too_much_is_stuck(body, points):
    surface = body.working_surface(points, body.faces, 300, fixed=np.arange(0, len(points), 2))
    assert surface.stuck is True
    assert len(surface.kept) > 600


def test_cancelling_reaches_every_step(body, points):
    """However often it was asked before, the next time it is asked the run ends."""
    asked: list[int] = []

    def counting():
        asked.append(len(asked))
        return False

    stages = []
    monitor = Monitor(lambda share, stage: stages.append((len(asked), stage)), cancelled=counting)
    body.working_surface(points, body.faces, 600, monitor=monitor)
    for stage in ("Coarse mesh", "Triangulation"):
        numbers = [number for number, each in stages if each == stage]
        assert max(numbers) > min(numbers)
    for number in range(len(asked)):
        calls = iter(range(len(asked) + 1))
        with pytest.raises(CancelledError):
            body.working_surface(points, body.faces, 600, monitor=Monitor(cancelled=lambda: next(calls) >= number))  # noqa: B023


def test_making_it_delaunay_can_be_cancelled(body, points, monkeypatch):
    handed = []

    def spy(triangulation, monitor):
        handed.append(monitor)
        return intrinsic_delaunay(triangulation, monitor)

    monkeypatch.setattr(module, "intrinsic_delaunay", spy)
    monitor = Monitor()
    body.working_surface(points, body.faces, 600, monitor=monitor)
    assert handed == [monitor]
