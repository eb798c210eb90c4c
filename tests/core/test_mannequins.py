"""The mannequin: a closed, symmetric body of human proportions, in the pose that was asked for."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from addon.core import InvalidMeshError, InvalidSettingsError, Settings, mannequin, pose_like
from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import signed_volume, surface_area
from addon.core.modelling.mannequins import A_POSE, T_POSE, VERTEX_COUNT
from addon.core.modelling.solids import Ellipsoid, RoundCone, smooth_union
from addon.core.modelling.surface_nets import surface_net
from tests.meshes.shapes import figure


def grid(reach, step):
    return (np.arange(-reach, reach + step, step),) * 3


def test_the_net_of_a_ball_has_its_area_volume_and_genus():
    axes = grid(1.5, 0.05)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    vertices, faces = surface_net(np.linalg.norm(points, axis=-1) - 1.0, axes)
    assert is_closed(faces)
    assert len(vertices) - len(faces) / 2 == 2
    assert signed_volume(vertices, faces) == pytest.approx(4 / 3 * np.pi, rel=0.01)
    assert surface_area(vertices, faces) == pytest.approx(4 * np.pi, rel=0.01)


def test_a_union_lies_between_its_solids_and_their_hull():
    axes = grid(3.0, 0.1)
    apart = [Ellipsoid((-1, 0, 0), (0.8, 0.8, 0.8)), Ellipsoid((1, 0, 0), (0.8, 0.8, 0.8))]
    joined = RoundCone((-1, 0, 0), (1, 0, 0), 0.8, 0.8)
    inside = smooth_union(apart, axes, 0.1) < 0
    of_each = np.logical_or(*(smooth_union([each], axes, 0.1) < 0 for each in apart))
    assert inside[of_each].all()
    assert not inside[smooth_union([joined], axes, 0.1) > 2].any()
    assert smooth_union(apart, axes, 0.4)[len(axes[0]) // 2, 30, 30] < smooth_union(apart, axes, 0.1)[30, 30, 30] * 0.4


@pytest.mark.parametrize("arms", [T_POSE, A_POSE, 70.0])
def test_it_is_closed_symmetric_and_stands(arms):
    vertices, faces = mannequin(arms)
    assert is_closed(faces)
    assert len(vertices) == VERTEX_COUNT
    assert len(vertices) - len(faces) / 2 == 2
    assert cKDTree(vertices).query(vertices * [-1, 1, 1])[0].max() < 1e-9
    assert vertices[:, 2].min() == 0.0
    assert 1.7 < vertices[:, 2].max() < 1.8
    assert 0.055 < signed_volume(vertices, faces) < 0.085  # cubic metres, of 55 to 85 kg


@pytest.mark.parametrize("arms", [T_POSE, A_POSE])
def test_its_arms_are_lowered_as_asked_for(arms):
    vertices, faces = mannequin(arms)
    flat = mannequin()[0]
    assert np.array_equal(faces, mannequin()[1])
    elbow, wrist = (vertices[np.abs(flat[:, 0] - place) < 0.01].mean(axis=0) for place in (0.46, 0.66))
    way = wrist - elbow
    assert np.degrees(np.arctan2(-way[2], way[0])) == pytest.approx(arms, abs=1.0)
    legs = flat[:, 2] < 1.2
    legs &= np.abs(flat[:, 0]) < 0.2
    assert np.array_equal(vertices[legs], flat[legs])


@pytest.mark.parametrize("arms", [91.0, -91.0, float("nan")])
def test_arms_out_of_bounds_are_refused(arms):
    with pytest.raises(InvalidSettingsError, match="-90 to 90"):
        mannequin(arms)


def test_a_reference_can_be_matched_in_one_pose_and_stand_in_another():
    vertices, faces = figure(13)
    turned = vertices[:, [1, 2, 0]]
    plain = pose_like(vertices, faces, vertices, faces, Settings())
    posed = pose_like(vertices, faces, vertices, faces, Settings(), reference_pose=turned)
    assert np.array_equal(posed.match.faces, plain.match.faces)
    here, there = (each - each.mean(axis=0) for each in (plain.vertices[:, [1, 2, 0]], posed.vertices))
    assert np.abs(here - there).max() < 1e-6


@pytest.mark.parametrize("pose", [np.zeros((3, 3)), np.zeros(5), np.full((4, 3), np.nan)])
def test_a_pose_that_is_none_of_the_reference_is_refused(pose):
    points, faces = (
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]),
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    )
    with pytest.raises(InvalidMeshError, match="one position for each of its 4"):
        pose_like(points, faces, points, faces, reference_pose=pose)
