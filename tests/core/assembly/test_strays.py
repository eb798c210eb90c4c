"""Vertices that were drawn far away from all their neighbours."""

import numpy as np
import pytest

from addon.core import canonical_form
from addon.core.assembly.strays import stray_vertices
from tests.meshes import shapes


def with_stray(figure, to):
    vertices, faces = figure[0].copy(), figure[1]
    stray = int(np.argmin(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1)))
    vertices[stray] += to
    return vertices, faces, stray


@pytest.mark.parametrize("to", [[0, 0, -4.0], [6.0, 0, 0]])
def test_a_stray_vertex_makes_no_spike_and_is_told(figure, to):
    vertices, faces, stray = with_stray(figure, to)
    sound, form = canonical_form(*figure), canonical_form(vertices, faces)
    assert stray_vertices(vertices, faces).tolist() == [stray]
    assert [each.kind for each in form.warnings if each not in sound.warnings] == ["stray_vertices"]
    assert len(form.feature_points) == len(sound.feature_points)
    others = np.arange(len(vertices)) != stray
    size = np.ptp(sound.vertices, axis=0).max()
    assert np.abs(form.vertices - sound.vertices)[others].max() < 0.02 * size
    ring = np.setdiff1d(faces[(faces == stray).any(axis=1)], stray)
    before, after = (np.linalg.norm(each[stray] - each[ring].mean(axis=0)) for each in (vertices, form.vertices))
    assert after == pytest.approx(before, rel=1e-6)


@pytest.mark.parametrize("height", [2.0, 15.0])
def test_the_tip_of_a_cone_is_none(height):
    around = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    points = np.concatenate([[[0, 0, height]], np.column_stack([np.cos(around), np.sin(around), np.zeros(8)])])
    faces = np.array([[0, 1 + k, 1 + (k + 1) % 8] for k in range(8)])
    assert not len(stray_vertices(points, faces))


def test_what_has_no_stray_vertex_stays_as_it_is(sphere):
    assert not len(stray_vertices(*sphere))


def test_a_body_with_riders_keeps_its_size(figure):
    """Their area is kept together, without that of the spike."""
    eye, its = shapes.sphere(2)
    whole = (
        np.concatenate([figure[0], figure[0][0] + 0.05 * eye]),
        np.concatenate([figure[1], its + len(figure[0])]),
    )
    sound = canonical_form(*whole)
    vertices, faces, stray = with_stray(whole, [0, 0, 30.0])
    form = canonical_form(vertices, faces)
    others = np.arange(len(vertices)) != stray
    size = np.ptp(sound.vertices, axis=0)
    np.testing.assert_allclose(np.ptp(form.vertices[others], axis=0), size, atol=0.01 * size.max())
