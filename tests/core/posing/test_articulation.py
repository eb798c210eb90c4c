import numpy as np
import pytest

from addon.core import CancelledError, Settings, canonical_form
from addon.core.limbs import limb_shapes
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.connectivity import vertex_pairs
from addon.core.mesh.geometry import signed_volume
from addon.core.posing.articulation import Articulation
from addon.core.posing.limb_amounts import limb_amounts
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


def test_moving_and_scaling_changes_nothing_else(figure, rotation):
    points, faces = figure
    form = canonical_form(points, faces).vertices
    chosen = points[:, 2] > np.quantile(points[:, 2], 0.8)
    here = limb_shapes(points, faces, form, chosen)[0]
    there = limb_shapes(3.0 * points @ rotation + 7, faces, 3.0 * form @ rotation + 7, chosen)[0]
    np.testing.assert_allclose(there, 3.0 * here @ rotation + 7, atol=1e-6 * np.ptp(there, axis=0).max())


def band_stretch(points, faces, form, chosen):
    """Check that nothing moves outside, and return the band's and the whole form's 99th percentile of distortion."""
    shape = limb_shapes(points, faces, form, chosen)[0]
    amounts = limb_amounts(points, faces, chosen)
    outside = amounts == 0
    assert outside.any()
    np.testing.assert_allclose(shape[outside], points[outside], atol=1e-13 * np.ptp(points, axis=0).max())
    assert not chosen[outside].any()
    assert (np.linalg.norm(shape - points, axis=1) > 0.01 * np.ptp(points, axis=0).max()).any()
    band = ((amounts > 0) & (amounts < 1))[vertex_pairs(faces)].any(axis=1)
    before = np.abs(edge_stretch(points, form, faces) - 1)
    after = np.abs(edge_stretch(points, shape, faces) - 1)
    return np.quantile(after[band], 0.99), np.quantile(before, 0.99)


@pytest.mark.parametrize(
    "name", ["man/walk1_04.obj", "woman/zombieWalk1_10.obj", "horse/horse_gallop_f00.obj", "bear/bear_run_f12.obj"]
)
def test_one_limb_moves_alone_and_stretches_less_than_the_whole_form_does(real_mesh, name):
    points, faces = real_mesh(name)
    found = canonical_form(points, faces)
    for patch in range(len(found.feature_points)):
        band, whole = band_stretch(points, faces, found.vertices, found.patches == patch)
        assert band <= whole


def test_one_limb_of_a_figure_moves_alone(figure):
    points, faces = figure
    found = canonical_form(points, faces)
    smallest = int(np.argmin(np.bincount(found.patches)))
    band, whole = band_stretch(points, faces, found.vertices, found.patches == smallest)
    assert band <= whole


def test_a_limb_that_keeps_its_pose_does_not_turn_the_rest(figure):
    points, faces = figure
    found = canonical_form(points, faces)
    limb = found.patches == int(np.argmin(np.bincount(found.patches)))
    shape = limb_shapes(points, faces, found.vertices, ~limb)[0]
    moved = np.linalg.norm(shape - found.vertices, axis=1) > 1e-12
    assert (moved & limb).any()
    assert np.count_nonzero(moved) < 0.5 * len(points)


def test_all_limbs_are_the_form_and_none_the_pose(figure):
    points, faces = figure
    form = points @ np.diag([1.0, 1.1, 0.9])
    everything = np.ones(len(points), dtype=bool)
    np.testing.assert_array_equal(limb_shapes(points, faces, form, everything)[0], form)
    np.testing.assert_allclose(limb_shapes(points, faces, form, ~everything)[0], points, atol=1e-12)


def test_in_betweens_of_a_limb_leave_the_rest_alone(figure):
    points, faces = figure
    found = canonical_form(points, faces)
    limb = found.patches == int(np.argmin(np.bincount(found.patches)))
    halfway, whole = limb_shapes(points, faces, found.vertices, limb, ways=(0.5, 1.0))
    outside = limb_amounts(points, faces, limb) == 0
    for shape in (halfway, whole):
        np.testing.assert_allclose(shape[outside], points[outside], atol=1e-13)
    tip = found.feature_points[int(np.argmin(np.bincount(found.patches)))]
    assert np.linalg.norm(halfway[tip] - points[tip]) < np.linalg.norm(whole[tip] - points[tip])


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


def test_a_small_limb_has_a_band_of_its_own(figure):
    points, faces = figure
    found = canonical_form(points, faces, Settings(prominence=0.03))
    for patch in range(len(found.feature_points)):
        amounts = limb_amounts(points, faces, found.patches != patch)
        assert amounts[found.patches == patch].min() == 0
        assert amounts[found.patches != patch].max() == 1
