"""The form of some limbs only."""

import numpy as np
import pytest

from addon.core import canonical_form
from addon.core.limbs import limb_shapes
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.edges import vertex_pairs
from addon.core.posing.limb_amounts import limb_amounts


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
