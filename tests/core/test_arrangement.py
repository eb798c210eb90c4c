"""The intrinsic start, the deformations and the detail pass."""

import numpy as np
import pytest

from addon.core import Settings, canonical_form
from addon.core.alignment import rigid_fit
from addon.core.arrangement import handedness, laid_out, landmark_distances
from addon.core.coarsening import coarsened
from addon.core.deformation import ElasticBody
from addon.core.delaunay import intrinsic_delaunay
from addon.core.detail import carried_by_frames
from addon.core.heat import HeatMethod
from addon.core.laplacian import mass, stiffness
from addon.core.measures import compactness_error, edge_stretch, surface_area
from addon.core.memory import memory_estimate
from addon.core.monitor import Monitor
from addon.core.scaling import farthest_points
from addon.core.spectrum import compute_spectrum
from addon.core.struts import struts_through
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
    body = ElasticBody(surface, points, figure[1], np.array([[0, 1000], [7, 2000]]))
    moved = body.deformed_towards(target, 10.0, 3, memory, pressure=True)
    np.testing.assert_allclose(moved, target, atol=1e-9)


def test_pressure_keeps_the_compactness(figure):
    points, surface = prepared(*figure)
    squashed = points * [1.0, 1.0, 0.4]
    body = ElasticBody(surface, points, figure[1])
    bare = body.deformed_towards(squashed, 30.0, 5)
    kept = body.deformed_towards(squashed, 30.0, 5, pressure=True)
    assert compactness_error(points, kept, figure[1]) < 0.1 * compactness_error(points, bare, figure[1])


def test_struts_join_the_two_sides_of_a_thin_body():
    vertices, faces = shapes.sphere(5)
    points, _surface = prepared(vertices * [1.0, 1.0, 0.1], faces)
    struts = struts_through(points, faces, np.zeros((len(points), 1)))
    assert len(struts) > 0.2 * len(points)
    one, two = points[struts[:, 0]], points[struts[:, 1]]
    assert (one[:, 2] * two[:, 2] < 0).all()
    inward = struts_through(points, faces[:, ::-1], np.zeros((len(points), 1)))
    np.testing.assert_array_equal(inward, struts)


def flask(around=40):
    """A ball with a pouch inside, open to the outside through a narrow neck."""
    outside = np.linspace(np.pi, 0.12, 40)  # from the south pole
    profile = np.column_stack([np.sin(outside), np.cos(outside)])
    inside = np.linspace(0.3, np.pi, 20)
    profile = np.concatenate([profile, np.column_stack([0.4 * np.sin(inside), 0.5 + 0.4 * np.cos(inside)])])
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    rings = profile[1:-1]
    ring = np.stack([rings[:, :1] * np.cos(turn), rings[:, :1] * np.sin(turn), np.tile(rings[:, 1:], around)], axis=-1)
    vertices = np.concatenate([ring.reshape(-1, 3), [[0, 0, -1], [0, 0, profile[-1, 1]]]])
    row, column = np.meshgrid(np.arange(len(rings) - 1), np.arange(around), indexing="ij")
    here, beside = row * around + column, row * around + (column + 1) % around
    last, i, j = (len(rings) - 1) * around, np.arange(around), (np.arange(around) + 1) % around
    faces = np.concatenate(
        [
            np.stack([here, beside, beside + around], axis=-1).reshape(-1, 3),
            np.stack([here, beside + around, here + around], axis=-1).reshape(-1, 3),
            np.column_stack([np.full(around, len(vertices) - 2), j, i]),
            np.column_stack([last + i, last + j, np.full(around, len(vertices) - 1)]),
        ]
    )
    return vertices, faces, np.arange(len(vertices)) >= 39 * around


def test_struts_bring_a_pouch_back_inside():
    vertices, faces, pouch = flask()
    assert is_closed(faces)
    assert signed_volume(vertices, faces) > 0
    points, surface = prepared(vertices, faces)
    pouch[-2] = False
    top = points[~pouch, 2].max()
    deep = pouch & (vertices[:, 2] < 0.6)
    target = points.copy()
    target[pouch, 2] = 2 * top - target[pouch, 2]  # distances on the surface don't know inside from outside
    left_out = {}
    for struts in (None, struts_through(points, faces, np.zeros((len(points), 1)))):
        moved = ElasticBody(surface, points, faces, struts).deformed_towards(target, 10.0, 20, memory=0.1)
        left_out[struts is not None] = (moved[deep, 2] > top).mean()
    assert left_out == {False: 1.0, True: 0.0}


def test_no_strut_joins_what_is_far_apart_on_the_surface():
    vertices, faces = shapes.sphere(5)
    points, _surface = prepared(vertices * [1.0, 1.0, 0.1], faces)
    sides = np.where(points[:, 2] > 0, 10.0, 0.0)[:, None]  # as if the other side were another limb
    assert not len(struts_through(points, faces, sides))


def test_preserve_detail_goes_from_the_bare_form_to_the_rigid_one(figure):
    vertices, faces = figure
    stretch = [
        np.abs(
            edge_stretch(vertices, canonical_form(vertices, faces, Settings(preserve_detail=much)).vertices, faces) - 1
        ).mean()
        for much in (0.0, 0.3, 0.5, 0.8, 1.0)
    ]
    assert stretch == sorted(stretch, reverse=True)
    assert stretch[-1] < 0.3 * stretch[0]


def test_frames_carry_a_rigid_motion_exactly(figure, rotation):
    points, _ = prepared(*figure)
    coarse = coarsened(points, figure[1], 500)
    small = points[coarse.kept]
    body = ElasticBody(intrinsic_delaunay(triangulated(small, coarse.faces)), small, coarse.faces)
    np.testing.assert_allclose(
        carried_by_frames(coarse, body, small @ rotation + 1.0, points), points @ rotation + 1.0, atol=1e-9
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
