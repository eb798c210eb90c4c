import numpy as np
import pytest

from addon.core import CancelledError, canonical_form
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.geometry import signed_volume
from addon.core.posing.articulation import Articulation
from addon.core.run.monitor import Monitor
from tests.meshes import shapes


def straightened(degrees):
    """A bent limb and the same limb straight, aligned to it."""
    points, faces = shapes.joint(degrees)
    straight = shapes.joint(0)[0]
    rotation, shift = rigid_fit(straight, points)
    return points, faces, straight @ rotation + shift


@pytest.mark.parametrize("degrees", [60, 120, 150])
def test_a_bent_limb_keeps_its_volume_half_way_where_a_blend_loses_it(degrees):
    points, faces, straight = straightened(degrees)
    volume = signed_volume(points, faces)
    halfway = Articulation(points, faces, straight).at(0.5)
    assert signed_volume(halfway, faces) == pytest.approx(volume, rel=0.03)
    if degrees >= 120:
        assert signed_volume((points + straight) / 2, faces) < 0.85 * volume


def test_it_starts_at_the_pose_and_ends_at_the_form(figure):
    points, faces = figure
    form = canonical_form(points, faces).vertices
    path = Articulation(points, faces, form)
    size = np.ptp(points, axis=0).max()
    np.testing.assert_allclose(path.at(0.0), points, atol=1e-12 * size)
    np.testing.assert_allclose(path.at(1.0), form, atol=1e-12 * size)
    np.testing.assert_allclose(path.at(1e-9), points, atol=1e-7 * size)
    np.testing.assert_allclose(path.at(1 - 1e-9), form, atol=1e-7 * size)


def test_halfway_there_a_joint_is_bent_half():
    points, faces, straight = straightened(120)
    halfway = Articulation(points, faces, straight).at(0.5)
    wanted = shapes.joint(60)[0]
    rotation, shift = rigid_fit(wanted, halfway)
    assert np.abs(wanted @ rotation + shift - halfway).max() < 0.02 * 4.0  # of its length


def test_a_whole_turn_is_no_limit():
    points, faces = shapes.joint(400, along=120, radius=0.1)
    straight = shapes.joint(0, along=120, radius=0.1)[0]
    rotation, shift = rigid_fit(straight, points)
    straight = straight @ rotation + shift
    wanted = (1 + edge_stretch(points, straight, faces)) / 2  # a bent tube has longer and shorter sides
    halfway = edge_stretch(points, Articulation(points, faces, straight).at(0.5), faces)
    linear = edge_stretch(points, (points + straight) / 2, faces)
    assert np.quantile(np.abs(halfway - wanted), 0.95) < 0.05
    assert np.quantile(np.abs(linear - wanted), 0.95) > 0.3


def test_it_can_be_cancelled(figure):
    points, faces = figure
    with pytest.raises(CancelledError):
        Articulation(points, faces, points, Monitor(cancelled=lambda: True))


def test_neighbours_that_turn_half_around_do_no_harm(sphere):
    points, faces = sphere
    upper = points[:, 2] > 0
    form = np.where(upper[:, None], points * [-1.0, -1.0, 1.0], points)
    assert np.abs(Articulation(points, faces, form).at(0.5)).max() < 3


def test_vertices_that_are_held_but_not_worked_on_do_not_tear(sphere):
    points, faces = sphere
    path = Articulation(points, faces, points @ np.diag([1.0, 1.2, 0.8]))
    amounts = np.ones(len(points))
    amounts[np.setdiff1d(np.arange(len(points)), path._surface.kept)[0]] = 0.0
    shape = path.at(amounts)
    assert edge_stretch(points, shape, faces).max() < 3
