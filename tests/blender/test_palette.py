"""Colours of patches and fields."""

import numpy as np
import pytest

pytest.importorskip("bpy")

from addon.blender.mesh_items.palette import as_seen, patch_colours, ramp
from tests.meshes import shapes


def test_neighbouring_patches_look_different():
    vertices, faces = shapes.grid(40, 40)
    cells = (vertices[:, 0] * 4.999).astype(int) * 5 + (vertices[:, 1] * 4.999).astype(int)
    colours = patch_colours(cells, faces)
    ends = cells[np.concatenate([faces[:, :2], faces[:, 1:]])]
    ends = ends[ends[:, 0] != ends[:, 1]]
    assert np.linalg.norm(colours[ends[:, 0]] - colours[ends[:, 1]], axis=1).min() > 0.15
    assert ((colours >= 0) & (colours <= 1)).all()


def test_the_ramp_grows_lighter_evenly():
    colours = ramp(np.linspace(0, 1, 50))
    luminance = colours[:, :3] @ [0.2126, 0.7152, 0.0722]
    lightness = np.cbrt(luminance)
    steps = np.diff(lightness)
    assert steps.min() > 0
    assert steps.max() < 2.5 * steps.min()


@pytest.mark.parametrize(("count", "apart"), [(5, 0.15), (8, 0.07), (12, 0.05)])
def test_patches_look_different_to_the_colour_blind(count, apart):
    patches = np.arange(count).repeat(3)
    faces = np.array([[3 * i, 3 * ((i + 1) % count), 3 * ((i + 2) % count)] for i in range(count)])
    seen = as_seen(patch_colours(patches, faces)[:, :3])
    assert np.allclose(as_seen(np.full((1, 3), 0.5))[0, 0, 1:], 0, atol=1e-6)  # grey is grey
    for looks in seen:
        distances = np.linalg.norm(looks[:, None] - looks[None], axis=2)
        assert distances[~np.eye(count, dtype=bool)].min() > apart


def test_neighbours_among_thousands_of_patches_look_different_to_everybody():
    rows = 45
    cells = np.arange(rows * rows).reshape(rows, rows)
    one, two, three, four = (each.ravel() for each in (cells[:-1, :-1], cells[:-1, 1:], cells[1:, :-1], cells[1:, 1:]))
    faces = np.concatenate([np.column_stack([one, two, three]), np.column_stack([four, three, two])])
    looks = as_seen(patch_colours(np.arange(rows * rows), faces)[:, :3])
    ends = np.concatenate([faces[:, :2], faces[:, 1:]])
    assert np.linalg.norm(looks[:, ends[:, 0]] - looks[:, ends[:, 1]], axis=2).min() > 0.05
