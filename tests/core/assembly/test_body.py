"""The pieces of one body, part by part."""

import numpy as np
import pytest

from addon.core.assembly.bodies import bodies_of
from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.geometry import of_unit_area
from addon.core.run.errors import InvalidSettingsError
from addon.core.run.monitor import Monitor
from tests.meshes import pieced, shapes


@pytest.fixture(scope="module")
def made():
    return pieced.character()[2]


@pytest.fixture(scope="module")
def bodies(made):
    return bodies_of(made.vertices, made.faces)


def test_parts_are_slices_of_the_vertices_and_of_the_triangles(made, bodies):
    (body,) = bodies.bodies
    assert len(body.parts) == 3
    pieces = {tuple(piece.vertices): piece for piece in connected_pieces(made.vertices, made.faces).pieces}
    first_vertex = first_face = 0
    for vertices, faces, samples in body.parts:
        assert (vertices.start, faces.start) == (first_vertex, first_face)
        piece = pieces[tuple(body.vertices[vertices])]
        np.testing.assert_array_equal(body.points[vertices], piece.points)
        np.testing.assert_array_equal(body.faces[faces] - vertices.start, piece.faces)
        centre, unit = of_unit_area(made.vertices, made.faces)[1:]
        np.testing.assert_allclose(samples.points * unit + centre, samples.on(piece.points), atol=1e-9)
        first_vertex, first_face = vertices.stop, faces.stop
    assert (first_vertex, first_face) == (len(body.vertices), len(body.faces))
    np.testing.assert_array_equal(np.sort(body.all_faces, axis=None), np.sort(made.faces, axis=None))


def test_each_vertex_of_a_rider_is_carried_by_one_near_it(made, bodies):
    (body,) = bodies.bodies
    size = of_unit_area(made.vertices, made.faces)[2]
    for rider in body.riders:
        apart = np.linalg.norm(rider.piece.points - body.points[rider.carriers], axis=1) / size
        assert np.median(apart) < (0.06 if rider.rigid else 0.03)
        assert rider.ground == ([rider.ground[0]] if rider.rigid else [0, 1, 2])
        assert (len(set(rider.carriers)) == 1) == rider.rigid
        if rider.rigid:  # at the one place where it is nearest
            carrier = body.points[rider.carriers[0]]
            nearest = np.linalg.norm(body.points[:, None] - rider.piece.points, axis=2).min(axis=1)
            assert np.linalg.norm(rider.piece.points - carrier, axis=1).min() / size < nearest.min() / size + 0.03
    assert sorted(rider.rigid for rider in body.riders) == [False, False, True]  # the shirt has a front and a back


def test_riders_go_where_the_body_goes(made, bodies, rotation):
    (body,) = bodies.bodies
    for rider, shape in zip(body.riders, body.with_riders(3 + body.points @ rotation, Monitor()), strict=True):
        np.testing.assert_allclose(shape, 3 + rider.piece.points @ rotation, atol=1e-5)


@pytest.mark.parametrize("given", [[], [[0, 1], [2]], [[0, 1]], [0.5], "0", None])
def test_what_is_no_list_of_vertices_is_refused(bodies, given):
    with pytest.raises(InvalidSettingsError) as raised:
        bodies.sources(given)
    assert raised.value.kind == "source_list"


def test_vertices_beyond_the_last_are_refused_and_the_last_is_named(made, bodies):
    last = len(made.vertices) - 1
    assert sum(len(each.positions) for each in bodies.sources([0, last])) == 2
    for given in ([last + 1], [-1]):
        with pytest.raises(InvalidSettingsError) as raised:
            bodies.sources(given)
        assert raised.value.kind == "source_range"
        assert raised.value.numbers["last"] == last
        with pytest.raises(InvalidSettingsError) as raised:
            bodies_of(made.vertices, made.faces, features=given)
        assert raised.value.kind == "vertex_range"
        assert raised.value.numbers["last"] == last


def test_a_stiff_piece_is_carried_where_it_touches():
    """A plate stands askew on a ball, one edge on it."""
    vertices, faces = shapes.sphere(4)
    plate, corners = shapes.grid(8, 8, 0.25, 0.25)
    plate = np.array([0.25, 0.25, 0]) - plate  # the edge that touches has the last vertices
    askew = np.column_stack([plate[:, 0] / 2, plate[:, 1] - 0.125, 1.0 + plate[:, 0] * np.sqrt(0.75)])
    (body,) = bodies_of(np.vstack([vertices, askew]), np.vstack([faces, corners + len(vertices)])).bodies
    (rider,) = body.riders
    assert rider.rigid
    assert len(set(rider.carriers)) == 1
    edge = askew[plate[:, 0] < 1e-9]
    assert np.linalg.norm(edge - body.points[rider.carriers[0]], axis=1).min() < 0.06
