"""Bridges between the parts of a body."""

import numpy as np
import pytest

from addon.core.assembly import bridges as module
from addon.core.assembly.bridges import bridges_between
from addon.core.assembly.contacts import sampled
from addon.core.mesh.connectivity import border_labels
from addon.core.mesh.edges import edge_table, vertex_pairs
from addon.core.mesh.geometry import of_unit_area, vertex_normals
from tests.meshes import shapes
from tests.meshes.tubes import akimbo

AROUND = 48


def turned(profile, lift):
    """A surface about the z axis through a profile of radii and heights, lifted by angle."""
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    rings = [np.column_stack([r * np.cos(angles), r * np.sin(angles), z + lift(angles)]) for r, z in profile]
    corners = [
        (row * AROUND + at, row * AROUND + (at + 1) % AROUND) for row in range(len(rings) - 1) for at in range(AROUND)
    ]
    faces = [face for i, j in corners for face in ((i, j, j + AROUND), (i, j + AROUND, i + AROUND))]
    return np.concatenate(rings), np.array(faces)


def neck_in_collar():
    """A neck whose flat shoulders lie under a collar in front and behind; at both sides the collar stands off."""
    slope, shoulders = 0.1, np.linspace(0.30, 0.08, 8)
    neck = [*((r, -slope * r) for r in shoulders), *((0.08, z) for z in np.linspace(0.03, 0.6, 16))]
    trunk = [*((0.5, z) for z in np.linspace(-1.5, -0.1, 30)), *((r, -slope * r) for r in np.linspace(0.46, 0.14, 10))]
    parts = [
        turned(neck, np.zeros_like),
        turned(trunk, lambda angle: 0.02 + 0.5 * np.maximum(np.abs(np.cos(angle)) - 0.9, 0)),
    ]
    faces = np.concatenate([parts[0][1], parts[1][1] + len(parts[0][0])])
    points = of_unit_area(np.concatenate([points for points, _ in parts]), faces)[0]
    part = np.repeat([0, 1], [len(points) for points, _ in parts])
    return points, faces, part, [sampled(points[part == at], parts[at][1]).points for at in (0, 1)]


def test_a_neck_that_its_collar_holds_in_front_and_behind_is_joined_on_both_sides():
    points, faces, part, surfaces = neck_in_collar()
    sides = points[np.unique(bridges_between(points, faces, part, surfaces)), 1]
    assert sides.min() < -0.05
    assert sides.max() > 0.05


def put_together(*meshes):
    """Some meshes as parts of unit area: points, triangles, parts, dense samples."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    faces = np.concatenate([own + start for (_, own), start in zip(meshes, starts[:-1], strict=True)])
    points = of_unit_area(np.concatenate([vertices for vertices, _ in meshes]), faces)[0]
    part = np.repeat(np.arange(len(meshes)), np.diff(starts))
    return points, faces, part, [sampled(points[part == at], own).points for at, (_, own) in enumerate(meshes)]


def joined_parts(part, bridges):
    """Which parts the bridges join, as pairs."""
    ends = np.sort(part[bridges], axis=1)
    return {(int(low), int(high)) for low, high in ends[:, [0, 2]]}


def ball(place):
    vertices, faces = shapes.sphere(2)
    return vertices + np.asarray(place, dtype=float), faces


def test_parts_that_touch_nowhere_are_linked_where_they_are_nearest():
    points, faces, part, surfaces = put_together(ball([0, 0, 0]), ball([9, 0, 0]), ball([4, 4, 0]))
    bridges = bridges_between(points, faces, part, surfaces)
    assert joined_parts(part, bridges) == {(0, 2), (1, 2)}
    for one, other in ((0, 2), (1, 2)):
        here = bridges[np.isin(part[bridges], [one, other]).all(axis=1)]
        assert 2 <= len(here) <= 6  # two for each of three links, fewer where they share a triangle
        between = np.linalg.norm(points[part == one][:, None] - points[part == other], axis=2)
        links = np.linalg.norm(points[here[:, 0]] - points[here[:, 1]], axis=1)
        assert links.min() == pytest.approx(between.min())
        assert links.max() < between.min() + 0.02


def test_each_part_is_linked_to_the_nearest_of_those_that_hang_together():
    row = put_together(*(ball([2.6 * at, 0, 0]) for at in (0, 2, 1, 3)))
    assert joined_parts(row[2], bridges_between(*row)) == {(0, 2), (1, 2), (1, 3)}


def test_one_part_has_no_bridges():
    points, faces, part, surfaces = put_together(ball([0, 0, 0]))
    assert bridges_between(points, faces, part, surfaces).shape == (0, 3)
    links, lengths = module._links(points, module._within_two_edges(len(points), vertex_pairs(faces)), part, surfaces)
    assert links.shape == (0, 2)
    assert lengths.shape == (0,)


def half_ring(turn, radius, gap=0.0):
    """Half of a ring in the plane z = 0, of a tube of radius 1; its ends are open."""
    vertices, faces = shapes.cylinder(24, 80, 1.0, np.pi)
    angle = np.interp(vertices[:, 2], [vertices[:, 2].min(), vertices[:, 2].max()], [gap, np.pi - gap]) + turn
    out = radius + vertices[:, 0]
    return np.column_stack([out * np.cos(angle), out * np.sin(angle), vertices[:, 1]]), faces


def test_a_ring_of_two_halves_stays_open_at_one_end():
    """Both ends meet: one joins the halves, and the way round from there to the other is long."""
    points, faces, part, surfaces = put_together(half_ring(0, 6.0, 0.002), half_ring(np.pi, 6.0, 0.002))
    bridges = bridges_between(points, faces, part, surfaces)
    sides = np.sign(points[bridges[:, 0], 0])
    assert len(np.unique(sides)) == 1
    assert len(np.unique(bridges[part[bridges] == 0])) >= 24


def test_two_ends_near_each_other_are_both_joined():
    """Beside the contact that joins two triangles the way to another is short; of a touch from one side never."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.01], [1, 0, 0.01], [0, 1, 0.01]]) * 0.1
    pairs = np.array([[0, 1], [0, 2], [1, 2], [3, 4], [3, 5], [4, 5]])
    part = np.repeat([0, 1], 3)

    def contact(links, around, score):
        lengths = np.linalg.norm(np.subtract(*points[np.array(links).T]), axis=1)
        return module._Contact(np.array(links), lengths, around, score)

    first, beside, touch = contact([[0, 3]], 0.5, 3.0), contact([[1, 4]], 0.5, 2.0), contact([[2, 5]], 0.1, 1.0)
    assert module._chosen(points, pairs, part, [first, beside, touch]).tolist() == [[0, 3], [1, 4]]
    assert module._chosen(10 * points, pairs, part, [first, beside, touch]).tolist() == [[0, 3]]
    assert module._chosen(points, pairs, part, [touch]).tolist() == [[2, 5]]


def test_an_arm_is_joined_at_its_shoulder_and_not_where_its_hand_lies():
    vertices, faces = shapes.sphere(4)
    points, faces, part, surfaces = put_together((12 * vertices, faces), akimbo())
    bridges = np.unique(bridges_between(points, faces, part, surfaces))
    assert len(bridges) > 20
    assert (points[bridges, 1] > 0).all()


def test_every_link_has_a_triangle_at_either_end_and_none_twice():
    vertices, triangles = shapes.grid(9, 9)
    points, faces, part, surfaces = put_together((vertices, triangles), (vertices + np.array([0, 0, 0.01]), triangles))
    bridges = bridges_between(points, faces, part, surfaces)
    assert len(np.unique(np.sort(bridges, axis=1), axis=0)) == len(bridges)
    assert all(part[start] != part[end] for start, end, _ in bridges)
    links = {tuple(sorted(each)) for each in np.concatenate([bridges[:, :2], bridges[:, 1:]]).tolist()}
    for vertex in range(len(points)):
        apart = np.linalg.norm(points[part != part[vertex]] - points[vertex], axis=1)
        linked = [pair for pair in links if vertex in pair]
        nearest = int(np.flatnonzero(part != part[vertex])[apart.argmin()])
        assert tuple(sorted((vertex, nearest))) in linked
    edges = {tuple(sorted(each)) for face in faces.tolist() for each in zip(face, face[1:] + face[:1], strict=True)}
    for start, end, beside in bridges.tolist():
        assert (min(start, beside), max(start, beside)) in edges or (min(end, beside), max(end, beside)) in edges


def test_a_sheet_has_no_contact_with_what_lies_behind_the_one_it_touches():
    sheet, own = shapes.grid(20, 20)
    part = np.concatenate([sheet, sheet - [0, 0, 0.031]]), np.concatenate([own, own + len(sheet)])  # .018 of the unit
    points, faces, numbers, surfaces = put_together(part, (sheet + np.array([0, 0, 0.009]), own))
    borders = np.full(len(points), -1)
    found = module._contacts(points, vertex_pairs(faces), vertex_normals(points, faces), borders, numbers, surfaces)
    assert len(found) == 1
    assert found[0].links[:, 0].max() < len(sheet)


def test_a_hole_narrower_than_what_touches_is_no_open_end():
    angles = np.linspace(0, 2 * np.pi, 6, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    points, loop = np.concatenate([0.005 * ring, 0.02 * ring + 1]), np.repeat([0, 1], 6)
    assert module._open_ends(points, loop).tolist() == [-1] * 6 + [1] * 6
    exact = np.array([[0.0, 0, 0], [module.TOUCH, 0, 0]])  # what is as far away as that does not touch
    assert module._open_ends(exact, np.zeros(2, dtype=np.int64)).tolist() == [0, 0]


@pytest.mark.parametrize(
    ("first", "second", "label"),
    [
        (7, 3, [0, 1]),  # the first holds the end alone
        (6, 4, [0, 0]),
        (4, 3, [0, 0]),
        (4, 2, [0, 1]),
    ],
)
def test_contacts_are_one_where_only_together_they_hold_seven_tenths_of_an_end(first, second, label):
    """An end of ten vertices, all on the border, and two contacts with as many others."""
    loop, part = np.repeat([0, -1], 10), np.repeat([0, 1], 10)
    here = np.arange(first + second)
    links = np.column_stack([here, here + 10])
    found = module._rings_closed(links, np.repeat([0, 1], [first, second]), loop, np.array([10]), part)
    assert found[[0, first]].tolist() == label
    assert len(np.unique(found)) == len(set(label))


@pytest.mark.parametrize(("open_ends", "factor"), [(True, 10), (False, 1)])
def test_a_contact_that_holds_an_open_end_counts_ten_times(open_ends, factor):
    """Its score: vertices of the smaller side, those of a border four times more, how far around, how near."""
    points, faces, part, surfaces = put_together(half_ring(0, 6.0, 0.002), half_ring(np.pi, 6.0, 0.002))
    loop = border_labels(faces, edge_table(faces)) if open_ends else np.full(len(points), -1)
    normals = vertex_normals(points, faces)
    contacts = module._contacts(points, vertex_pairs(faces), normals, loop, part, surfaces)
    assert len(contacts) == 2
    for contact in contacts:
        ends = [np.unique(side) for side in contact.links.T]
        smaller = min(len(end) + 4 * (loop[end] >= 0).sum() for end in ends)
        around = np.prod([1 - np.linalg.norm(normals[end].mean(axis=0)) for end in ends])
        near = 1 / (1 + (contact.lengths.min() / 0.01) ** 2)
        assert contact.score == pytest.approx(factor * smaller / (smaller + 8) * around * near)
