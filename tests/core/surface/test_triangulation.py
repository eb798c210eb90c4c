import numpy as np
import pytest

from addon.core import CancelledError
from addon.core.run.monitor import Monitor
from addon.core.surface.delaunay import intrinsic_delaunay, midpoint_refined
from addon.core.surface.triangulation import corner_cotangents, corner_lengths, face_areas, mollified, triangulated
from tests.meshes import shapes


def test_area_of_a_rectangle_and_of_its_refinement():
    surface = triangulated(*shapes.grid(7, 5, 3.0, 2.0))
    assert face_areas(surface.lengths).sum() == pytest.approx(6.0, rel=1e-14)
    assert face_areas(midpoint_refined(surface).lengths).sum() == pytest.approx(6.0, rel=1e-14)


def test_mollification_leaves_good_triangles_alone_and_mends_flat_ones():
    good = triangulated(*shapes.grid(4, 4)).lengths
    np.testing.assert_array_equal(mollified(good), good)
    flat = np.array([[2.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    assert face_areas(flat)[0] == 0
    assert (face_areas(mollified(flat)) > 0).all()


def test_delaunay_keeps_the_surface_and_leaves_no_obtuse_pair(figure):
    vertices, faces = figure
    stretched = triangulated(vertices * [1.0, 7.0, 1.0], faces)
    flipped = intrinsic_delaunay(stretched)
    assert (flipped.faces != stretched.faces).any()
    assert face_areas(flipped.lengths).sum() == pytest.approx(face_areas(stretched.lengths).sum(), rel=1e-12)
    opposite = np.bincount(flipped.edges.ravel(), weights=corner_cotangents(flipped.lengths).ravel())
    assert opposite.min() >= -1e-9
    assert np.bincount(stretched.edges.ravel(), weights=corner_cotangents(stretched.lengths).ravel()).min() < -0.1


def test_delaunay_hears_a_cancel_and_says_when_it_has_given_up(figure):
    vertices, faces = figure
    stretched = triangulated(vertices * [1.0, 7.0, 1.0], faces)
    asked = []

    def cancelled():
        asked.append(1)
        return len(asked) > 2

    with pytest.raises(CancelledError):
        intrinsic_delaunay(stretched, Monitor(cancelled=cancelled))
    assert len(asked) == 3
    monitor = Monitor()
    intrinsic_delaunay(stretched, monitor, max_rounds=2)
    assert [each.kind for each in monitor.warnings] == ["flips_exhausted"]
    assert "less accurate" in monitor.warnings[0]
    monitor = Monitor()
    intrinsic_delaunay(stretched, monitor)
    assert not monitor.warnings


def test_delaunay_leaves_squares_as_they_are():
    surface = triangulated(*shapes.grid(9, 9))
    np.testing.assert_array_equal(intrinsic_delaunay(surface).faces, surface.faces)


def test_refined_edges_are_shared_by_two_triangles_also_where_triangles_wrap_around_a_limb():
    vertices, faces = shapes.cylinder(3, 40, radius=0.02, height=3.0)
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    fine = midpoint_refined(surface)
    counts = np.bincount(fine.edges.ravel())
    lengths = np.full(len(counts), np.nan)
    lengths[fine.edges.ravel()] = fine.lengths.ravel()
    np.testing.assert_allclose(lengths[fine.edges], fine.lengths, rtol=1e-12)  # both sides agree on the length
    assert sorted(set(counts[counts > 0])) == [1, 2]
    assert (counts == 1).sum() == 2 * (np.bincount(surface.edges.ravel()) == 1).sum()  # the border, halved
    ends = np.sort(np.stack([np.roll(fine.faces, -1, axis=1), np.roll(fine.faces, -2, axis=1)], axis=2), axis=2)
    first = np.zeros((len(counts), 2), dtype=int)
    first[fine.edges.ravel()] = ends.reshape(-1, 2)
    np.testing.assert_array_equal(first[fine.edges], ends)  # both sides agree on the ends


def test_lengths_are_opposite_to_their_corners():
    lengths = corner_lengths(np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]]))
    np.testing.assert_allclose(lengths, [[5, 4, 3]])
