"""The intrinsic start, the deformations and the detail pass."""

import numpy as np
import pytest

from addon.core import Settings, canonical_form
from addon.core.alignment import rigid_fit
from addon.core.arrangement import handedness, laid_out, landmark_distances
from addon.core.coarsening import coarsened
from addon.core.deformation import deformed_towards, right_side_out
from addon.core.delaunay import intrinsic_delaunay
from addon.core.detail import carried_by_frames
from addon.core.heat import HeatMethod
from addon.core.laplacian import mass, stiffness
from addon.core.measures import compactness_error, edge_stretch, surface_area
from addon.core.memory import memory_estimate
from addon.core.monitor import Monitor
from addon.core.scaling import farthest_points
from addon.core.spectrum import compute_spectrum
from addon.core.surface import is_closed, signed_volume, triangulated
from tests.sample import shapes


def prepared(vertices, faces):
    points = (vertices - vertices.mean(axis=0)) / np.sqrt(surface_area(vertices, faces))
    surface = intrinsic_delaunay(triangulated(points, faces))
    return points, surface


def layout_of(vertices, faces):
    points, surface = prepared(vertices, faces)
    spectrum = compute_spectrum(stiffness(surface), mass(surface), 60)
    heat = HeatMethod(surface, 0.005, refine=False)
    landmarks, distances = farthest_points(heat, np.array([0]), heat.distances([0]), 60, Monitor())
    return laid_out(landmark_distances(distances, landmarks, spectrum), landmarks, points, faces)


def test_volume_and_closedness():
    vertices, faces = shapes.sphere(4)
    assert signed_volume(vertices, faces) == pytest.approx(4 / 3 * np.pi, rel=0.01)
    assert signed_volume(vertices, faces[:, ::-1]) == pytest.approx(-4 / 3 * np.pi, rel=0.01)
    assert is_closed(faces)
    assert not is_closed(faces[1:])
    assert not is_closed(np.concatenate([faces, faces]))


def test_handedness_tells_a_ball_from_a_tie():
    vertices, faces = shapes.sphere(4)
    assert handedness(vertices, faces) == pytest.approx(4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1, 1, -1], faces) == pytest.approx(-4 / 3 * np.pi * 3**1.5, rel=0.02)
    assert handedness(vertices * [1, 1, 0], faces) == 0


def test_the_layout_is_outside_out_or_flat(figure):
    for vertices, faces in (shapes.sphere(4), figure):
        layout = layout_of(vertices, faces)
        assert handedness(layout, faces) >= 0
        inward = layout_of(vertices, faces[:, ::-1])  # a mesh whose triangles face inwards
        turn, shift = rigid_fit(inward, layout)
        assert np.abs(inward @ turn + shift - layout).max() < 1e-6


def test_a_mirrored_mesh_has_the_mirrored_layout(figure):
    vertices, faces = figure
    layout = layout_of(vertices, faces)
    mirrored = layout_of(vertices * [-1, 1, 1], faces[:, ::-1])
    turn, shift = rigid_fit(mirrored, layout * [-1, 1, 1])
    assert np.abs(mirrored @ turn + shift - layout * [-1, 1, 1]).max() < 1e-6


@pytest.mark.parametrize("memory", [1.0, 0.0])
def test_a_rigid_motion_of_the_target_is_followed_exactly(figure, rotation, memory):
    points, surface = prepared(*figure)
    target = points @ rotation + 0.3
    moved = deformed_towards(surface, points, target, 10.0, 3, memory, figure[1])
    np.testing.assert_allclose(moved, target, atol=1e-9)


def test_pressure_keeps_the_compactness(figure):
    points, surface = prepared(*figure)
    squashed = points * [1.0, 1.0, 0.4]
    bare = deformed_towards(surface, points, squashed, 30.0, 5)
    kept = deformed_towards(surface, points, squashed, 30.0, 5, closed_faces=figure[1])
    assert compactness_error(points, kept, figure[1]) < 0.1 * compactness_error(points, bare, figure[1])


def test_a_pocket_that_is_inside_out_is_found():
    vertices, faces = shapes.sphere(4)
    points, surface = prepared(vertices, faces)
    dented = points.copy()
    cap = points[:, 2] > 0
    dented[cap, 2] *= -0.9  # one half pushed into the other
    trust = right_side_out(surface, points, dented, faces, 0.001)
    rim = cap & (points[:, 2] < 0.3 * points[:, 2].max())
    assert trust[rim].mean() < 0.5
    assert trust[points[:, 2] < -0.7 * points[:, 2].max()].min() > 0.9
    np.testing.assert_array_equal(right_side_out(surface, points, points, faces, 0.001), 1.0)


def test_preserve_detail_goes_from_the_bare_form_to_the_rigid_one(figure):
    vertices, faces = figure
    stretch = [
        np.abs(
            edge_stretch(vertices, canonical_form(vertices, faces, Settings(preserve_detail=much)).vertices, faces) - 1
        ).mean()
        for much in (0.0, 0.3, 0.5, 0.8, 1.0)
    ]
    assert stretch == sorted(stretch, reverse=True)
    assert stretch[-1] < 0.2 * stretch[0]


def test_frames_carry_a_rigid_motion_exactly(figure, rotation):
    points, _ = prepared(*figure)
    coarse = coarsened(points, figure[1], 500)
    small = points[coarse.kept]
    surface = intrinsic_delaunay(triangulated(small, coarse.faces))
    np.testing.assert_allclose(
        carried_by_frames(coarse, surface, small, small @ rotation + 1.0, points), points @ rotation + 1.0, atol=1e-9
    )


def test_draft_normal_and_full_agree(figure):
    vertices, faces = figure
    forms = [canonical_form(vertices, faces, Settings(quality=quality)) for quality in ("draft", "normal", "full")]
    for form in forms[:2]:
        assert len(form.feature_points) == len(forms[2].feature_points)
        turn, shift = rigid_fit(form.vertices, forms[2].vertices)
        apart = np.sqrt(((form.vertices @ turn + shift - forms[2].vertices) ** 2).sum(axis=1).mean())
        assert apart < 0.06 * np.sqrt(surface_area(vertices, faces))
    assert forms[0].pair_count < forms[1].pair_count < forms[2].pair_count


def test_the_memory_is_known_beforehand():
    normal = [memory_estimate(count, Settings()) for count in (1_000, 10_000, 1_000_000)]
    assert normal == sorted(normal)
    assert normal[-1] < 6
    assert memory_estimate(10_000, Settings(quality="full")) > normal[1]
