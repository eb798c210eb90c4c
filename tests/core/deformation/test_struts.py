"""Struts through the interior, in the elastic body and in the stress."""

import numpy as np
import pytest

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.deformation.struts import struts_through
from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import signed_volume
from addon.core.surface.laplacian import stiffness_and_mass
from tests.meshes import shapes
from tests.meshes.shapes import prepared


def test_struts_join_the_two_sides_of_a_thin_body():
    vertices, faces = shapes.sphere(4)
    points, _surface = prepared(vertices * [1.0, 1.0, 0.1], faces)
    struts = struts_through(points, faces, np.zeros((len(points), 1)))
    assert len(struts) > 0.2 * len(points)
    one, two = points[struts[:, 0]], points[struts[:, 1]]
    assert (one[:, 2] * two[:, 2] < 0).all()
    inward = struts_through(points, faces[:, ::-1], np.zeros((len(points), 1)))
    np.testing.assert_array_equal(inward, struts)


def tube(sides, rings=40, thickness=0.15):
    """A closed tube of any number of sides, with a point at each end."""
    turn = 2 * np.pi * np.arange(sides) / sides
    along = np.linspace(-1, 1, rings)
    ring = np.stack([thickness * np.cos(turn), thickness * np.sin(turn)], axis=1)
    vertices = np.concatenate([np.column_stack([ring, np.full(sides, height)]) for height in along])
    vertices = np.concatenate([vertices, [[0, 0, -1.05], [0, 0, 1.05]]])
    row, side = (grid.ravel() for grid in np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij"))
    a, b = row * sides + side, row * sides + (side + 1) % sides
    last, i = (rings - 1) * sides, np.arange(sides)
    j = (i + 1) % sides
    ends = [np.column_stack([np.full(sides, len(vertices) - 2), j, i])]
    ends += [np.column_stack([np.full(sides, len(vertices) - 1), last + i, last + j])]
    walls = [np.column_stack([a, b, b + sides]), np.column_stack([a, b + sides, a + sides])]
    return vertices, np.concatenate(walls + ends)


def house():
    """A ball pushed into the shape of a house, mirror-symmetric."""
    vertices, faces = shapes.sphere(4)
    roof = np.where(vertices[:, 2] > 0, 2 * (1 - np.abs(vertices[:, 0])), 0.2)
    return np.column_stack([0.3 * vertices[:, 0], vertices[:, 1], roof * vertices[:, 2]]), faces


@pytest.mark.parametrize("shape", [tube(12), tube(6), tube(7), shapes.sphere(3), house()])
def test_rounding_decides_nothing_on_a_symmetric_body(shape):
    points, _surface = prepared(*shape)
    none = np.zeros((len(points), 1))
    struts = struts_through(points, shape[1], none)
    assert len(struts) > 20
    for seed in range(4):
        turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        np.testing.assert_array_equal(struts_through(points @ turn, shape[1], none), struts)


def test_struts_of_a_tube_go_across_it():
    points, _surface = prepared(*tube(12))
    struts = struts_through(points, tube(12)[1], np.zeros((len(points), 1)))
    wall = struts[(struts < len(points) - 2).all(axis=1)]
    straight = wall[:, 1] - wall[:, 0] == 6
    assert straight.mean() > 0.9


def test_a_sheet_has_no_struts_and_a_body_with_a_hole_has():
    vertices, faces = shapes.grid(41, 21, 2.0, 1.0)
    wave = np.column_stack([vertices[:, :2], 0.25 * np.sin(2 * np.pi * vertices[:, 0])])
    points, _surface = prepared(wave, faces)
    assert not len(struts_through(points, faces, np.zeros((len(points), 1))))
    vertices, faces = tube(12)
    faces = faces[:-12]  # the lid
    points, _surface = prepared(vertices[:-1], faces)
    assert len(struts_through(points, faces, np.zeros((len(points), 1)))) > 100


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
        moved = ElasticBody(*stiffness_and_mass(surface), points, faces, struts).towards(target, 10.0, 20, bending=0.1)
        left_out[struts is not None] = (moved[deep, 2] > top).mean()
    assert left_out == {False: 1.0, True: 0.0}


def test_no_strut_joins_what_is_far_apart_on_the_surface():
    vertices, faces = shapes.sphere(4)
    points, _surface = prepared(vertices * [1.0, 1.0, 0.1], faces)
    sides = np.where(points[:, 2] > 0, 10.0, 0.0)[:, None]  # as if the other side were another limb
    assert not len(struts_through(points, faces, sides))
