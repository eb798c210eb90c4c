import numpy as np

from addon.core.mesh.connectivity import component_labels
from addon.core.mesh.edges import vertex_pairs
from addon.core.patching.cells import patches_of, voronoi_cells
from tests.meshes import shapes


def test_cells_on_a_plane_are_those_of_the_nearest_site():
    vertices, faces = shapes.grid(31, 31)
    sites = np.array([45, 400, 900])
    apart = np.linalg.norm(vertices[:, None] - vertices[sites], axis=2)
    np.testing.assert_array_equal(voronoi_cells(apart, sites, faces), apart.argmin(axis=1))


def test_a_tie_goes_to_the_first_site():
    vertices, faces = shapes.grid(11, 11)
    sites = np.array([55, 65])
    apart = np.linalg.norm(vertices[:, None] - vertices[sites], axis=2)
    for noise in np.random.default_rng(1).normal(size=(4, *apart.shape)):
        assert (voronoi_cells(apart + 1e-12 * noise, sites, faces)[vertices[:, 0] == 0.5] == 0).all()


def test_islands_join_the_cell_around_them():
    vertices, faces = shapes.grid(21, 21)
    sites = np.array([0, 440])
    apart = np.linalg.norm(vertices[:, None] - vertices[sites], axis=2)
    island = np.array([388, 389, 409])
    apart[island, 0] = 0.0  # near the second site, but claimed by the first
    cells = voronoi_cells(apart, sites, faces)
    assert (cells[island] == 1).all()
    for index, site in enumerate(sites):
        inside = faces[(cells[faces] == index).all(axis=1)]
        label = component_labels(len(vertices), vertex_pairs(inside))
        assert (label[np.unique(inside)] == label[site]).all()


def test_closed_cells_cover_every_triangle_and_share_a_band():
    _, faces = shapes.grid(12, 12)
    cells = (np.arange(144) % 12 >= 6).astype(int)
    left, right = patches_of(cells, faces, 2)
    assert len(np.unique(np.concatenate([left.faces, right.faces]), axis=0)) == len(faces)
    for patch in (left, right):
        np.testing.assert_array_equal(patch.vertices, np.unique(patch.faces))
    shared = np.intersect1d(left.vertices, right.vertices)
    np.testing.assert_array_equal(np.unique(shared % 12), [5, 6])


def test_open_cells_share_no_vertex_and_are_measured_on_the_triangles_of_closed_ones():
    _, faces = shapes.grid(12, 12)
    cells = (np.arange(144) % 12 >= 6).astype(int)
    for index, (closed, opened) in enumerate(
        zip(patches_of(cells, faces, 2), patches_of(cells, faces, 2, closed=False), strict=True)
    ):
        np.testing.assert_array_equal(opened.faces, closed.faces)
        np.testing.assert_array_equal(opened.vertices, np.flatnonzero(cells == index))
