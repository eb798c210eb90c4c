"""Meshes parted along triangles: closed again, nothing joined anew, borders of before stay."""

import numpy as np

from addon.core.fused.contact_faces import contact_faces, contacts_between
from addon.core.fused.on_given import given_of, limbs_on_given, shape_on_given
from addon.core.fused.parting import OpenMesh, capped
from addon.core.mesh.connectivity import component_labels
from addon.core.mesh.edges import edge_table, is_closed, vertex_pairs
from addon.core.mesh.repair import repaired
from addon.core.run.monitor import Monitor
from tests.meshes import shapes
from tests.meshes.fused import parted
from tests.meshes.rings import ring


def euler(faces):
    return len(np.unique(faces)) - len(vertex_pairs(faces)) + len(faces)


def test_a_ring_that_is_parted_is_a_closed_tube():
    points, faces, along = ring()
    unrolled = np.column_stack([along, np.zeros((len(along), 2))])
    cut = np.ptp(along[faces], axis=1) > np.pi
    assert euler(faces) == 0
    mesh = parted(points, faces, cut, unrolled)
    assert mesh.caps == 2
    assert is_closed(mesh.faces)
    assert euler(mesh.faces) == 2
    assert np.array_equal(mesh.vertices[mesh.origin >= 0], points[mesh.origin[mesh.origin >= 0]])


def test_lips_that_touch_are_not_joined_again_by_repair():
    points, faces, along = ring()
    strip = np.ptp(along[faces], axis=1) > np.pi
    mesh = parted(points, faces, strip, np.column_stack([along, np.zeros((len(along), 2))]))
    again = repaired(mesh.vertices, mesh.faces)
    assert euler(again.faces) == 2


def test_a_vertex_between_two_fans_is_doubled():
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    both = np.concatenate([tetrahedron, np.array([0, 4, 5, 6])[tetrahedron]])
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]])
    mesh = parted(points, both, np.zeros(8, dtype=bool), points)
    assert len(mesh.vertices) == 8
    assert (mesh.origin == 0).sum() == 2
    assert component_labels(8, vertex_pairs(mesh.faces)).max() == 1
    here = mesh.vertices[mesh.origin == 0]
    assert np.linalg.norm(here[0] - here[1]) > 0.05  # or they would be joined again


def test_holes_of_before_stay_open():
    points, faces = shapes.sphere(3)
    open_ = faces[~(faces == 0).any(axis=1)]
    mesh = parted(points, open_, np.zeros(len(open_), dtype=bool), points)
    assert mesh.caps == 0
    assert len(edge_table(mesh.faces).alone) == len(edge_table(open_).alone)


def test_what_hangs_on_one_edge_goes_too():
    """A cap would lie on it, the other way round, and repair would tear both out."""
    points, faces, along = ring()
    strip = np.ptp(along[faces], axis=1) > np.pi
    ragged = strip.copy()
    beside = np.flatnonzero((along[faces].min(axis=1) == 0) & ~strip)
    ragged[beside[::2]] = True  # every other triangle of the next row
    mesh = parted(points, faces, ragged, np.column_stack([along, 0 * along, 0 * along]))
    again = repaired(mesh.vertices, mesh.faces)
    assert len(again.faces) == len(mesh.faces)
    assert is_closed(again.faces)


def test_long_edges_of_caps_are_split():
    points, faces, along = ring()
    mesh = parted(points, faces, np.ptp(along[faces], axis=1) > np.pi, points * [1, 1, 0])
    caps = mesh.faces[(mesh.origin[mesh.faces] < 0).any(axis=1)]
    assert len(caps) > 0
    assert (mesh.origin < 0).any()


def test_triangles_that_only_a_bad_fit_tears_are_no_contact():
    """On a plain sheet a jump of the place is no contact: there is a short way round."""
    points, faces = shapes.sphere(4)
    points = points / np.sqrt(4 * np.pi)
    places = points + np.where(points[:, :1] > 0.2, [[0.3, 0, 0]], 0.0) * (points[:, 1:2] > 0)
    assert not contact_faces(points, faces, places, Monitor()).any()


def test_the_strip_that_closes_a_ring_is_a_contact():
    points, faces, along = ring()
    size = np.sqrt(
        np.linalg.norm(np.cross(*(points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))), axis=1).sum() / 2
    )
    places = np.column_stack([along, np.zeros((len(along), 2))]) / size
    found = contact_faces(points / size, faces, places, Monitor())
    assert np.array_equal(found, np.ptp(along[faces], axis=1) > np.pi)
    assert contacts_between(faces[found], (along > np.pi).astype(int)) == [(0, 1)]


def test_shapes_and_labels_come_back_to_the_mesh_as_given():
    points, faces, along = ring()
    strip = np.ptp(along[faces], axis=1) > np.pi
    wide = strip | (along[faces].max(axis=1) < 0.4)  # takes whole rings of vertices with it
    mesh = parted(points, faces, wide, np.column_stack([along, np.zeros((len(along), 2))]))
    back = shape_on_given(mesh, mesh.vertices, len(points), faces)
    kept = np.isin(np.arange(len(points)), mesh.origin)
    assert not kept.all()
    np.testing.assert_allclose(back[kept], points[kept], atol=1e-12)
    assert np.linalg.norm(back - points, axis=1).max() < 0.3  # a membrane, not the ring
    assert given_of(mesh).min() >= 0


def test_limbs_come_back_to_the_mesh_as_given():
    from addon.core import canonical_form

    points, faces, along = ring()
    mesh = parted(points, faces, np.ptp(along[faces], axis=1) > np.pi, np.column_stack([along, 0 * along, 0 * along]))
    form = canonical_form(mesh.vertices, mesh.faces)
    (body,) = limbs_on_given(mesh, form.bodies)
    assert np.array_equal(body.vertices, np.arange(len(points)))
    tips = body.vertices[body.tips]
    assert np.ptp(along[tips]) > 5  # both ends of the tube


def test_a_cap_makes_no_edge_of_four_triangles():
    """A bowl of two triangles: its border has four corners, and the shorter diagonal is an edge already."""
    points = np.array([[1.0, 0, 0], [0, 0.5, 0.1], [-1, 0, 0], [0, -0.5, 0.1]])
    faces = np.array([[0, 1, 3], [1, 2, 3]])
    mesh = capped(OpenMesh(points, faces, np.arange(4), [[3, 2, 1, 0]]), points, 100.0)
    table = edge_table(mesh.faces)
    assert table.count.max() == 2
    assert is_closed(mesh.faces)
