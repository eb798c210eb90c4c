"""Very many small pieces: scales, cards of hair, the specks around a scan."""

import numpy as np
import pytest

from addon.core import Settings, canonical_form
from addon.core.assembly.bodies import bodies_of
from addon.core.assembly.contacts import sampled
from addon.core.assembly.crowd import crowd_contacts, crowds
from addon.core.assembly.pieces import MEASURED, Piece, connected_pieces
from addon.core.assembly.riding import Ground, ridden
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area
from addon.core.run.errors import InvalidMeshError
from addon.core.run.monitor import Monitor
from tests.meshes import pieced, shapes

SCALES = 700


@pytest.fixture(scope="module")
def scaly():
    made = pieced.character()[2]
    vertices, faces, under = pieced.with_scales(made.vertices, made.faces, SCALES)
    return made, vertices, faces, under


@pytest.fixture(scope="module")
def form(scaly):
    return canonical_form(*scaly[1:3])


def test_a_character_with_hundreds_of_scales_is_one_body_with_the_features_of_its_skin(scaly, form):
    made, vertices, faces, _ = scaly
    bare = canonical_form(made.vertices, made.faces)
    assert len(bodies_of(vertices, faces).bodies) == 1
    assert len(form.feature_points) == len(bare.feature_points)
    assert form.feature_points.max() < len(made.vertices)
    assert [each.kind for each in form.warnings].count("small_pieces_ride") == 1
    rotation, shift = rigid_fit(form.vertices[: len(made.vertices)], bare.vertices)
    off = form.vertices[: len(made.vertices)] @ rotation + shift - bare.vertices
    assert np.sqrt((off**2).sum(axis=1).mean()) < 0.03 * np.sqrt(surface_area(made.vertices, made.faces))


def test_every_scale_keeps_its_shape_and_its_place_on_the_skin(scaly, form):
    made, vertices, faces, under = scaly
    size = np.sqrt(surface_area(made.vertices, made.faces))
    before, after = (each[len(made.vertices) :].reshape(SCALES, 4, 3) for each in (vertices, form.vertices))
    lengths = [np.linalg.norm(each[:, :, None] - each[:, None], axis=-1) for each in (before, after)]
    stretch = surface_area(form.vertices, faces) / surface_area(vertices, faces)
    np.testing.assert_allclose(lengths[1] / np.sqrt(stretch), lengths[0], rtol=0.02, atol=1e-12)
    far = np.linalg.norm(after.mean(axis=1) - form.vertices[made.faces[under]].mean(axis=1), axis=1) / size
    assert np.quantile(far, 0.95) < 0.01
    patches = form.patches[len(made.vertices) :].reshape(SCALES, 4)
    assert (patches == patches[:, :1]).all()
    assert np.mean(patches[:, 0] == form.patches[made.faces[under, 0]]) > 0.95


def test_the_specks_around_a_scan_have_no_form_of_their_own():
    vertices, faces = shapes.figure()
    ball, its = shapes.sphere(1)
    size = np.ptp(vertices, axis=0).max()
    places = np.random.default_rng(0).normal(size=(6, 3))
    specks = [0.004 * size * ball + 2 * size * place / np.linalg.norm(place) for place in places]
    every = [faces, *(its + len(vertices) + len(ball) * index for index in range(len(specks)))]
    form, bare = canonical_form(np.vstack([vertices, *specks]), np.vstack(every)), canonical_form(vertices, faces)
    np.testing.assert_array_equal(form.feature_points, bare.feature_points)
    assert "Small loose parts (6) follow" in " ".join(form.warnings)
    again = form.vertices[len(vertices) :].reshape(len(specks), -1, 3)
    for speck, moved in zip(specks, again, strict=True):
        np.testing.assert_allclose(
            np.linalg.norm(moved - moved[0], axis=1), np.linalg.norm(speck - speck[0], axis=1), rtol=1e-3
        )


@pytest.mark.parametrize("unit", [1e-140, 1.0, 1e150])
def test_a_piece_of_the_crowd_goes_with_the_nearest_group(unit):
    ball, faces = shapes.sphere(2)

    def piece(radius, x):
        return Piece(np.arange(len(ball)), unit * (radius * ball + [x, 0, 0]), faces)

    found = crowds([piece(1, 0), piece(0.9, 9), piece(0.01, 3), piece(0.01, 7), piece(0.009, 8.05)])
    assert [(len(group), len(crowd)) for group, crowd in found] == [(1, 1), (2, 1)]


def test_beyond_the_pieces_that_are_measured_the_smallest_are_the_crowd():
    ball, faces = shapes.sphere(1)
    sizes = np.linspace(1, 0.5, MEASURED + 20)
    each = [Piece(np.arange(len(ball)), size * ball + [1.9 * i, 0, 0], faces) for i, size in enumerate(sizes)]
    found = crowds(each)
    assert sum(len(group) for group, _ in found) == MEASURED
    assert sum(len(crowd) for _, crowd in found) == 20
    assert found[-1][1][-1] is each[-1]


def test_a_crowd_rides_on_what_most_of_it_lies_on():
    """A card from one plate to the next, two thirds of it over the second; and one far above both."""
    vertices, faces = shapes.grid(20, 20)
    plates = [sampled(vertices + np.array([x, 0, 0]), faces) for x in (0, 1)]
    small, its = shapes.grid(12, 4, 0.12, 0.04)
    cards = [sampled(small + place, its) for place in ([0.96, 0.5, 0.005], [0.2, 0.5, 3.0])]
    (one, contact), (other, far) = crowd_contacts(cards, plates, Monitor())
    assert (one, other) == (1, 0)
    assert contact.gap == pytest.approx(0.005, abs=0.003)
    assert far.gap == pytest.approx(3, abs=0.01)


def test_riders_moved_at_once_go_where_each_goes_alone():
    vertices, faces = shapes.grid(40, 40)
    below = sampled(vertices, faces, 0.01)
    bent = below.points + np.column_stack([0 * below.points[:, :2], 0.3 * below.points[:, 0] ** 2])
    small, its = shapes.grid(3, 3, 0.03, 0.03)
    places = np.random.default_rng(0).uniform(0.05, 0.9, (300, 2))
    pieces = [Piece(np.arange(len(small)), small + np.array([x, y, 0.005]), its) for x, y in places]
    samples = [sampled(piece.points, its) for piece in pieces]
    ground = Ground(below.points, bent)
    together = ridden(pieces, samples, ground, rigid=True, monitor=Monitor())
    for index in (0, 17, 299):
        (alone,) = ridden(pieces[index : index + 1], samples[index : index + 1], ground, rigid=True, monitor=Monitor())
        np.testing.assert_allclose(together[index], alone, atol=1e-12)


def test_a_heap_of_loose_triangles_is_refused_and_so_are_pieces_without_end(scaly):
    _, vertices, faces, _ = scaly
    with pytest.raises(InvalidMeshError, match=r"70[0-9] loose parts, more than 500"):
        canonical_form(vertices, faces, Settings(pieces="apart"))
    with pytest.raises(InvalidMeshError, match="501 loose parts, more than 500"):
        connected_pieces(np.random.default_rng(0).normal(size=(1503, 3)), np.arange(1503).reshape(-1, 3))
    ball, its = shapes.sphere(2)
    dust = np.random.default_rng(0).normal(size=(60_003, 3))
    with pytest.raises(InvalidMeshError, match="20,002 loose parts, more than 20,000"):
        connected_pieces(np.vstack([ball, dust]), np.vstack([its, np.arange(60_003).reshape(-1, 3) + len(ball)]))
