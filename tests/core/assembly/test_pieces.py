"""A mesh as connected pieces."""

import numpy as np
import pytest

from addon.core.assembly.bodies import bodies_of
from addon.core.assembly.gathering import gathered
from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import surface_area
from tests.meshes import shapes


def test_loose_faces_of_one_surface_become_one_surface(figure):
    vertices, faces = figure
    pieces = connected_pieces(vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3))
    assert len(pieces.pieces) == 1
    assert is_closed(pieces.faces)
    assert len(pieces.pieces[0].vertices) == len(vertices)


def test_two_sheets_on_each_other_stay_two():
    vertices, faces = shapes.grid(7, 5)
    pieces = connected_pieces(np.vstack([vertices, vertices]), np.vstack([faces, faces + len(vertices)]))
    assert [len(piece.vertices) for piece in pieces.pieces] == [35, 35]


@pytest.mark.parametrize("together", [True, False])
def test_pieces_come_largest_first_and_back_together(figure, sphere, together):
    vertices = np.vstack([0.1 * sphere[0] + 9, figure[0], [[5.0, 5, 5]]])
    faces = np.vstack([sphere[1], figure[1] + len(sphere[0])])
    pieces = connected_pieces(vertices, faces)
    assert [len(piece.vertices) for piece in pieces.pieces] == [len(figure[0]), len(sphere[0])]
    assert surface_area(pieces.pieces[0].points, pieces.pieces[0].faces) == pytest.approx(surface_area(*figure))
    bodies = bodies_of(vertices, faces, together=together)
    back = gathered(bodies, [body.points for body in bodies.bodies], np.zeros_like(vertices))
    np.testing.assert_array_equal(back[:-1], vertices[:-1])
    assert (back[-1] == 0).all()
    chosen = bodies.sources([0, len(sphere[0]), 3])[1]
    np.testing.assert_array_equal(chosen.positions, [0, 2])
    np.testing.assert_array_equal(chosen.vertices, [0, 3])
    assert [each.kind for each in bodies.apart] == [
        "loose_vertices",
        "several_bodies" if together else "several_pieces",
    ]
