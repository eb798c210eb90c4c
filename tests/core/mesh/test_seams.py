"""Seams: coincident borders are one, whatever their rounding; what only touches stays apart."""

import numpy as np
import pytest

from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.edges import edge_table, is_closed
from addon.core.mesh.repair import repaired
from addon.core.mesh.seams import joined_at_seams
from tests.meshes import shapes


def flat_shaded(vertices, faces):
    """Every triangle with corners of its own, as flat shading is exported."""
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


def places(vertices, faces):
    """How many vertices are left."""
    return len(np.unique(joined_at_seams(vertices, faces, edge_table(faces))))


@pytest.fixture(scope="module")
def figure():
    return shapes.figure(16)


def test_a_mesh_whose_every_corner_is_its_own_is_whole_again(figure):
    vertices, faces = figure
    mesh = repaired(*flat_shaded(vertices, faces))
    assert is_closed(mesh.faces)
    assert len(np.unique(mesh.faces)) == len(vertices)
    np.testing.assert_array_equal(mesh.unjoined, flat_shaded(vertices, faces)[1])
    np.testing.assert_array_equal(mesh.representative[mesh.unjoined], mesh.faces)


@pytest.mark.parametrize(("apart", "whole"), [(1e-7, True), (1e-4, False)])
def test_joining_has_a_tolerance(apart, whole, figure):
    vertices, faces = figure
    cut, corners = flat_shaded(vertices, faces)
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    shaken = cut + np.random.default_rng(0).uniform(-0.4, 0.4, cut.shape) * apart * size
    assert (places(shaken, corners) == len(vertices)) == whole


def test_the_tolerance_is_small_against_the_edges_however_large_the_mesh():
    vertices, faces = flat_shaded(*shapes.sphere(1))
    fine = np.concatenate([1e-7 * vertices, 1e-7 * vertices + 100.0])
    assert places(fine, np.concatenate([faces, faces + len(vertices)])) == 84


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize("touching", [False, True])
def test_a_cap_that_touches_along_one_edge_stays_a_piece(touching, flat):
    vertices, faces = shapes.sphere(3)
    cap = faces[(vertices[faces][:, :, 2] > 0.5).all(axis=1)]
    lifted = vertices * 1.01
    if touching:
        edges = edge_table(cap)
        one = edges.alone[0]
        for end in (edges.tail[one], edges.head[one]):
            lifted[end] = vertices[end]
    parts = [(vertices, faces), (lifted, cap)]
    if flat:
        parts = [flat_shaded(*each) for each in parts]
    (points, corners), (others, other_corners) = parts
    both = np.concatenate([points, others]), np.concatenate([corners, other_corners + len(points)])
    assert len(connected_pieces(*both).pieces) == 2


def test_a_patchwork_of_many_pieces_is_whole_however_little_two_of_them_share():
    vertices, faces = shapes.grid(61, 61)
    column = np.minimum((vertices[faces].mean(axis=1)[:, 0] * 30).astype(int), 29)
    numbers = np.where(column[:, None] == 0, faces, faces + len(vertices))  # a strip, and the rest of it in blocks
    block = 1 + (vertices[faces].mean(axis=1)[:, 1] * 30).astype(int)
    numbers = np.where(column[:, None] > 0, faces + block[:, None] * len(vertices), numbers)
    used, corners = np.unique(numbers, return_inverse=True)
    cut = vertices[used % len(vertices)]
    assert len(cut) > len(vertices)
    assert places(cut, corners.reshape(-1, 3)) == len(vertices)


def test_sheets_that_lie_on_each_other_all_over_stay_two():
    vertices, faces = shapes.grid(5, 5)
    twice = np.concatenate([vertices, vertices]), np.concatenate([faces, faces[:, ::-1] + len(vertices)])
    assert places(*twice) == 2 * len(vertices)


def test_what_is_unjoined_follows_left_out_and_flipped_faces(figure):
    vertices, faces = figure
    cut, corners = flat_shaded(vertices, faces)
    spare = np.concatenate([corners[:5, [0, 0, 1]], corners, corners[:9]])
    spare[40:60] = spare[40:60, ::-1]
    mesh = repaired(cut, spare)
    assert len(mesh.faces) == len(faces)
    np.testing.assert_array_equal(mesh.representative[mesh.unjoined], mesh.faces)
    assert {tuple(sorted(each)) for each in mesh.unjoined.tolist()} == {tuple(each) for each in corners.tolist()}
