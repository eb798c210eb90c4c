import numpy as np
import pytest

from addon.core import InvalidMeshError
from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.edges import is_closed
from addon.core.mesh.repair import repaired
from tests.meshes import shapes

TRIANGLE = np.eye(3)


@pytest.mark.parametrize(
    ("vertices", "faces", "words"),
    [
        ([], [], "no faces"),
        ([[0, 0, 0], [1, 0]], [[0, 1, 0]], "arrays of numbers"),
        (TRIANGLE + 1j, [[0, 1, 2]], "arrays of numbers"),
        (TRIANGLE, np.zeros((0, 3), int), "no faces"),
        (TRIANGLE, [[0, 1, 3]], "outside 0 to 2"),
        (TRIANGLE, [[0, 1, -1]], "outside 0 to 2"),
        (TRIANGLE, [[0, 1, 2**31]], "outside 0 to 2"),
        (TRIANGLE, [[0, 1, 1]], "no area"),
        (TRIANGLE, [[0.0, 1.0, 2.0]], "integers"),
        (TRIANGLE, [[0, 1, 2, 0]], "triangles"),
        (TRIANGLE[:, :2], [[0, 1, 2]], r"\(n, 3\)"),
        (np.where(TRIANGLE == 1, np.nan, TRIANGLE), [[0, 1, 2]], "not numbers"),
        (np.where(TRIANGLE == 1, np.inf, TRIANGLE), [[0, 1, 2]], "not numbers"),
        (np.zeros((3, 3)), [[0, 1, 2]], "no area"),
        (np.outer(np.arange(3), np.ones(3)), [[0, 1, 2]], "no area"),
        ([[1.0025146, -0.0026421, 0.01280845], *[[0.002098, 0.98928661, 0.0072319]] * 2], [[0, 1, 2]], "no area"),
        (np.random.default_rng(0).normal(size=(1503, 3)), np.arange(1503).reshape(-1, 3), "501 loose parts"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_refused_with_the_reason(vertices, faces, words):
    with pytest.raises(InvalidMeshError, match=words):
        connected_pieces(vertices, faces)


def test_a_sound_mesh_is_left_as_it_is(figure):
    mesh = repaired(*figure)
    np.testing.assert_array_equal(mesh.faces, figure[1])
    np.testing.assert_array_equal(mesh.representative, np.arange(len(figure[0])))
    assert mesh.warnings == []


def test_faces_that_use_a_vertex_twice_and_copies_are_left_out(figure):
    vertices, faces = figure
    spare = np.vstack([faces[:5, [0, 1, 1]], faces[:50], faces[7:9, ::-1], faces])
    mesh = repaired(vertices, spare)
    assert sorted(map(tuple, np.sort(mesh.faces, axis=1))) == sorted(map(tuple, np.sort(faces, axis=1)))
    assert is_closed(mesh.faces)
    assert "5 faces" in mesh.warnings[0]
    assert "52 faces" in mesh.warnings[1]


def test_seams_are_closed_and_the_surface_is_whole_again(figure):
    vertices, faces = figure
    half = vertices[faces].mean(axis=1)[:, 2] > np.median(vertices[:, 2])
    apart = np.where(half[:, None], faces + len(vertices), faces)
    kept, corners = np.unique(apart, return_inverse=True)
    cut = np.vstack([vertices, vertices])[kept]
    mesh = repaired(cut, corners.reshape(-1, 3))
    assert is_closed(mesh.faces)
    assert "taken as joined" in mesh.warnings[0]
    assert len(np.unique(mesh.faces)) == len(vertices)
    np.testing.assert_array_equal(cut[mesh.representative], cut)


def test_faces_turned_over_are_turned_back(figure):
    vertices, faces = figure
    some = np.random.default_rng(0).uniform(size=len(faces)) < 0.3
    mesh = repaired(vertices, np.where(some[:, None], faces[:, ::-1], faces))
    tail, head = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    assert len(np.unique(tail * len(vertices) + head)) == len(tail)  # every edge once each way
    assert f"{np.count_nonzero(some):,} faces" in mesh.warnings[0]


def test_a_one_sided_surface_stays_as_it_is():
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    across = np.linspace(-0.3, 0.3, 5)
    radius = 1 + across[None] * np.cos(turn / 2)[:, None]
    points = np.stack([radius * np.cos(turn)[:, None], radius * np.sin(turn)[:, None],
                       across[None] * np.sin(turn / 2)[:, None]], axis=2)  # fmt: skip
    number = np.arange(200).reshape(40, 5)
    after = np.vstack([number[1:], number[:1, ::-1]])
    a, b, c, d = number[:, :-1], number[:, 1:], after[:, :-1], after[:, 1:]
    faces = np.vstack([np.stack([a, b, c], axis=2).reshape(-1, 3), np.stack([b, d, c], axis=2).reshape(-1, 3)])
    mesh = repaired(points.reshape(-1, 3), faces)
    assert np.count_nonzero((mesh.faces != faces).any(axis=1)) == 0


def test_far_from_the_origin_single_precision_is_told():
    vertices, faces = shapes.sphere(2)
    far = (vertices + 1e6).astype(np.float32)
    assert "rounded to" in repaired(far, faces).warnings[0]
    assert repaired(vertices + 1e6, faces).warnings == []
    assert repaired(vertices.astype(np.float32) + np.float32(10), faces).warnings == []
