"""Who is part of a body, and who rides."""

import numpy as np
import pytest

from addon.core.assembly.contacts import Contact, Samples, contacts_between, sampled
from addon.core.assembly.pieces import Piece
from addon.core.assembly.roles import roles_of
from addon.core.mesh.geometry import of_unit_area
from addon.core.run.monitor import Monitor
from tests.meshes import shapes
from tests.meshes.tubes import akimbo


def roles(*meshes):
    """Roles of some meshes, the largest first, and their unit of length."""
    pieces, samples, unit = put_together(*meshes)
    return roles_of(pieces, samples, contacts_between(pieces, samples, Monitor())), unit


def put_together(*meshes):
    """Some meshes as pieces, with all lengths in the square root of their whole area: pieces, samples, that unit."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    faces = np.concatenate([own + start for (_, own), start in zip(meshes, starts[:-1], strict=True)])
    points, _, unit = of_unit_area(np.concatenate([vertices for vertices, _ in meshes]), faces)
    pieces = [
        Piece(np.arange(start, end), points[start:end], own)
        for start, end, (_, own) in zip(starts[:-1], starts[1:], meshes, strict=True)
    ]
    return pieces, [sampled(piece.points, piece.faces) for piece in pieces], unit


def ball(radius, x=0.0, y=0.0, z=0.0):
    vertices, faces = shapes.sphere(3)
    return radius * vertices + np.array([x, y, z]), faces


def tube(radius, start, length, x=0.0):
    vertices, faces = shapes.cylinder(24, 60, radius, length)
    return vertices - [0, 0, vertices[:, 2].min() - start] + np.array([x, 0, 0]), faces


@pytest.mark.parametrize(
    ("radius", "gap", "rides"),
    [(0.2, 0.03, True), (0.2, 0.06, True), (0.65, 0.06, True), (0.78, 0.06, False), (0.2, 0.2, False)],
)
def test_what_is_near_rides_where_it_is_smaller_than_half_and_what_is_far_never(radius, gap, rides):
    unit = np.sqrt(4 * np.pi * (1 + radius**2))
    found, _ = roles(ball(1.0), ball(radius, 1 + radius + gap * unit))
    assert found.riders == ([(1, 0)] if rides else [])
    assert found.bodies == ([[0]] if rides else [[0], [1]])


def test_the_size_that_counts_is_that_of_the_largest_host():
    """A third body between half of the second and half of the first."""
    first, second, third = ball(1.0), ball(0.8, 5.0), ball(0.64, -1 - 0.64 - 0.3)
    found, unit = roles(first, second, third)
    assert 0.04 < 0.3 / unit < 0.1
    assert found.riders == [(2, 0)]
    assert found.bodies == [[0], [1]]


@pytest.mark.parametrize(("gap", "bodies"), [(0.01, [[0, 1]]), (0.03, [[0, 1]]), (0.037, [[0, 1]]), (0.06, [[0], [1]])])
def test_an_arm_in_a_loose_sleeve_belongs_to_the_body(gap, bodies):
    """A tube that begins inside the end of another, farther from it all around than a touch."""
    unit = np.sqrt(2 * np.pi * 3.75)
    found, _ = roles(tube(1, 0, 2), tube(1 - gap * unit, 1.9, 2))
    assert found == (bodies, [])


@pytest.mark.parametrize(("gap", "bodies"), [(0.01, [[0, 1]]), (0.03, [[0], [1]])])
def test_ends_that_face_each_other_hold_only_where_they_touch(gap, bodies):
    unit = np.sqrt(2 * np.pi * 3.9)
    found, _ = roles(tube(1, 0, 2), tube(1, 2 + gap * unit, 1.9))
    assert found == (bodies, [])


def test_tubes_side_by_side_are_two_bodies_and_a_much_smaller_one_rides():
    for length, bodies, riders in ((3.9, [[0], [1]], []), (2.2, [[0], [1]], []), (1.6, [[0]], [(1, 0)])):
        found, _ = roles(tube(0.4, 0, 4), tube(0.4, 0, length, 0.81))
        assert (found.bodies, found.riders) == (bodies, riders)


def test_a_body_between_two_is_measured_by_the_larger():
    """The smaller neighbour is less than twice as large, the larger one more."""
    found, _ = roles(tube(0.4, 0, 6), tube(0.4, 0, 3.4, 1.62), tube(0.4, 0, 2.2, 0.81))
    assert found.bodies == [[0], [1]]
    assert found.riders in ([(2, 0)], [(2, 1)])


def test_a_sleeve_rides_and_an_arm_in_its_open_end_is_part():
    sleeve = tube(0.21, 1.0, 2.0)
    found, _ = roles(tube(0.2, 0, 6), sleeve)
    assert found == ([[0]], [(1, 0)])
    found, _ = roles(tube(0.25, 0, 6), tube(0.23, 5.9, 3.0))
    assert found == ([[0, 1]], [])


def test_two_that_touch_a_larger_one_both_ride():
    found, _ = roles(tube(0.4, 0, 6), tube(0.4, 0, 2, 0.81), tube(0.4, 0, 1.9, -0.81))
    assert found.bodies == [[0]]
    assert sorted(found.riders) == [(1, 0), (2, 0)]


def test_an_open_end_on_a_closed_ball_is_a_joint():
    found, _ = roles(ball(1.0), tube(0.3, 0.955, 3.0))
    assert found == ([[0, 1]], [])


def test_riders_come_after_what_carries_them():
    """A button on a pocket on a ball: the button lies nearest to the pocket."""
    vertices, faces = shapes.grid(12, 12, 0.5, 0.5)
    flat = vertices - vertices.mean(axis=0)
    pocket = flat + np.array([0, 0, 1.03]), faces
    button = 0.1 * flat + np.array([0, 0, 1.04]), faces
    found, _ = roles(ball(1.0), pocket, button)
    assert found == ([[0]], [(1, 0), (2, 1)])


@pytest.mark.parametrize(("cut", "carrier"), [(0.002, 1), (0.09, 0)])
def test_what_was_cut_off_rides_where_it_was_cut(cut, carrier):
    """A fingertip beside a wall: its side lies on the wall, its border on that of the finger."""
    vertices, faces = shapes.grid(40, 40, 4.0, 4.0)
    wall = np.column_stack([vertices[:, [0, 1]] - 2.0, np.zeros(len(vertices))])[:, [2, 0, 1]], faces
    finger = tube(0.1, -1.5, 1.5, 0.115)
    vertices, faces = shapes.sphere(3)
    half = faces[(vertices[faces, 2] > -1e-9).all(axis=1)]
    used, corners = np.unique(half, return_inverse=True)
    tip = 0.1 * vertices[used] * [1, 1, 3] + [0.115, 0, cut], corners.reshape(-1, 3)
    found, _ = roles(wall, finger, tip)
    assert (2, carrier) in found.riders


def test_a_piece_far_from_the_body_that_hangs_on_a_rider_rides_there():
    """A braid lies on the back of a head and hangs down; a bead at its end is near nothing but the braid."""
    unit = np.sqrt(4 * np.pi)
    braid = tube(0.02, 0, 0.16 * unit, 1.02)
    braid = braid[0] - [0, 0, 0.01 * unit], braid[1]
    bead = 0.03 * ball(1.0)[0] + [1.02, 0, 0.16 * unit], ball(1.0)[1]
    found, _ = roles(ball(1.0), braid, bead)
    assert found == ([[0]], [(1, 0), (2, 1)])


def test_an_arm_is_part_wherever_its_hand_lies():
    found, _ = roles(ball(12.0), akimbo())
    assert found == ([[0, 1]], [])


@pytest.mark.parametrize(
    ("radius", "length", "start", "role"),
    [
        (0.015, 1.4, -0.7, "rides"),  # a spear in a fist
        (0.015, 1.4, 0.2, "part"),  # a tail
        (0.060, 1.4, -0.7, "part"),  # arms, one mesh, through a trunk
        (0.022, 0.9, -0.45, "part"),  # shorter ones: thickness counts relative to length
        (0.010, 0.9, -0.45, "rides"),
    ],
)
def test_a_stick_held_in_the_middle_rides_and_what_is_thick_or_held_at_its_end_is_part(radius, length, start, role):
    found, _ = roles(ball(0.25), tube(radius, start, length))
    assert found.bodies == ([[0]] if role == "rides" else [[0, 1]])
    assert found.riders == ([(1, 0)] if role == "rides" else [])


@pytest.mark.parametrize(("fewer", "role"), [(0, "rides"), (1, "part")])
def test_what_others_cover_to_three_quarters_rides(fewer, role):
    """An arm in a sleeve that exactly three quarters of its samples touch, the lower ones, and one fewer."""
    pieces, (first, second), _ = put_together(tube(0.2, 0.0, 6.0), tube(0.17, 3.75, 3.0))
    count = 4 * (len(second.points) // 4)
    corners, weights, points, normals = (each[:count] for each in second[:4])
    second = Samples(corners, weights, points, normals, second.area)
    order = np.argsort(np.argsort(points[:, 2]))
    contacts = contacts_between(pieces, [first, second], Monitor())
    touching = order < 3 * count // 4 - fewer
    contacts[1, 0] = Contact(np.where(touching, 0.01, 0.5), contacts[1, 0].nearest[:count])
    found = roles_of(pieces, [first, second], contacts)
    assert found == (([[0]], [(1, 0)]) if role == "rides" else ([[0, 1]], []))


def capsule(radius, start, length):
    """A ball pulled apart along z."""
    vertices, faces = shapes.sphere(4)
    return radius * vertices + [0, 0, start + radius] + np.where(
        vertices[:, 2:] > 0, [0, 0, length - 2 * radius], 0
    ), faces


@pytest.mark.parametrize("bend", [0, 60, 90])
@pytest.mark.parametrize(("gap", "radius"), [(0.02, 0.13), (0.1, 0.13), (0.05, 0.17)])
def test_limbs_that_only_a_ball_joins_are_one_body(bend, gap, radius):
    """As in every ball-jointed figure: the ball rides on both limbs, which do not hold each other."""
    upper, lower = capsule(0.15, gap / 2, 1.2), capsule(0.135, gap / 2, 1.2)
    turn = np.radians(180 - bend)
    about = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    found, _ = roles(upper, (lower[0] @ about.T, lower[1]), ball(radius))
    assert found.bodies in ([[0, 1, 2]], [[0, 1]])


def test_only_the_pieces_that_are_needed_join_hosts():
    """Two balls in one joint."""
    found, _ = roles(capsule(0.15, 0.05, 1.2), capsule(0.14, -1.25, 1.2), ball(0.14), ball(0.12))
    assert found.bodies == [[0, 1, 2]]
    assert [rider for rider, _ in found.riders] == [3]


@pytest.mark.parametrize(("neck", "height", "is_part"), [(0.5, 2.56, True), (1.0, 2.61, False)])
def test_a_small_head_is_part_where_its_neck_is_a_joint(neck, height, is_part):
    """It does not extend far; a neck holds all around, a ball that lies on top does not."""
    vertices, faces = shapes.sphere(4)
    head = 0.15 * vertices * np.where(vertices[:, 2:] < 0, [neck, neck, 1.2], 1.0)
    found, unit = roles(capsule(0.4, 0, 2.4), (head + np.array([0, 0, height]), faces))
    assert 0.3 / unit < 0.15
    assert (found.bodies == [[0, 1]]) == is_part


def test_what_hangs_by_an_end_is_part_and_what_lies_along_rides():
    """A leg under a skirt, whose wall is on one side of it, and one strapped along the same wall."""
    skirt, leg = tube(0.5, 0, 1.6), capsule(0.1, -1.3, 1.6)
    found, _ = roles(skirt, (leg[0] + [0.36, 0, 0], leg[1]))
    assert found == ([[0, 1]], [])
    found, _ = roles(skirt, (leg[0] + [0.36, 0, 1.3], leg[1]))
    assert found == ([[0]], [(1, 0)])


def test_beside_a_hip_one_leg_hangs_and_a_sheath_lies_along():
    hip = ball(1.0)
    hanging, lying = capsule(0.1, -2.2, 1.6), capsule(0.1, -0.8, 1.6)
    found, _ = roles(hip, (hanging[0] + [0.75, 0, 0], hanging[1]))
    assert found == ([[0, 1]], [])
    found, _ = roles(hip, (lying[0] + [1.1, 0, 0], lying[1]))
    assert found == ([[0]], [(1, 0)])


def test_a_limb_hangs_on_a_body_by_small_pieces_between():
    """Beads on a string: large ones hold nothing from around, but each touches the next; small ones are joints."""
    beads = [ball(0.25, z=height) for height in (1.3, 1.85)]
    found, unit = roles(ball(1.0), capsule(0.25, 2.15, 1.5), *beads)
    assert 1.15 / unit > 0.1
    assert found == ([[0, 1, 2, 3]], [])
    beads = [ball(0.08, z=1.08 + 0.17 * index) for index in range(3)]
    found, _ = roles(ball(1.0), capsule(0.1, 1.53, 1.5), *beads)
    assert found.bodies == [[0, 1, 2, 3, 4]]


def test_a_piece_between_two_bodies_is_in_one():
    """Two balls of one size, and a limb that hangs on a bead between them."""
    limb = capsule(0.12, -2.0, 1.6)
    found, _ = roles(ball(1.0, x=-1.08), ball(1.0, x=1.08), limb, ball(0.1, z=-0.33), ball(0.08, z=0.0))
    inside = [piece for body in found.bodies for piece in body]
    assert len(inside) == len(set(inside))
    assert sorted(inside + [rider for rider, _ in found.riders]) == [0, 1, 2, 3, 4]


def test_pieces_in_a_row_that_reach_far_together_are_part():
    """Beads that touch, each too small to be a part."""
    beads = [ball(0.11, x=1.1 + 0.2 * index) for index in range(6)]
    found, unit = roles(ball(1.0), *beads)
    assert 0.22 / unit < 0.15
    assert found == ([list(range(7))], [])
    found, _ = roles(ball(1.0), *beads[:2])
    assert found.bodies == [[0]]


def test_a_hand_near_a_thigh_is_part_by_its_arm():
    """The hand is large enough to be a part by itself, and near the body, but it touches the last segment."""
    vertices, faces = capsule(0.3, -1.6, 1.65)
    arm = [ball(0.11, x=x, z=z) for x, z in ((1.0, 0.45), (1.2, 0.45), (1.38, 0.36), (1.45, 0.16))]
    found, unit = roles(ball(1.0), (vertices + np.array([1.45, 0, 0]), faces), *arm)
    assert 0.01 < 0.15 / unit < 0.04
    assert found == ([list(range(6))], [])


def test_a_row_comes_before_a_piece_that_is_only_near():
    """By itself the hand is a part, held by nothing, and what is left of the arm is too short."""
    vertices, faces = capsule(0.3, -1.6, 1.9)
    hand = vertices + np.array([1.45, 0, 0]), faces
    arm = [ball(0.25, x=x, z=z) for x, z in ((0.898, 0.898), (1.2856, 0.545))]
    for segments, bodies in ((arm, [[0, 1, 2, 3]]), ([], [[0, 1]])):
        found, unit = roles(ball(1.0), hand, *segments)
        assert found.bodies == bodies
        assert 0.01 < 0.15 / unit < 0.04
