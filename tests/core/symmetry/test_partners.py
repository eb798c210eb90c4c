"""Left and right of posed bodies, against what their makers know."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial import KDTree

from addon.core import Settings, canonical_form
from addon.core.mesh.geometry import surface_area, vertex_areas
from addon.core.symmetry.mirror import asymmetry
from tests.meshes import shapes
from tests.meshes.shapes import Mesh

POSES = ("man/dance1_00", "woman/zombieWalk1_10", "horse/horse_gallop_f00", "bear/bear_run_f12")
REST = {"man": "rest", "woman": "rest", "horse": "bind", "bear": "bind"}


def true_partners(vertices):
    """The map of a body at rest to its mirror image along the first axis."""
    middle = (vertices.max(axis=0) + vertices.min(axis=0)) / 2
    far, partner = KDTree(vertices).query((vertices - middle) * [-1.0, 1, 1] + middle)
    assert far.max() < 1e-3 * np.ptp(vertices)
    return partner


@pytest.mark.parametrize("name", POSES)
def test_forms_of_symmetric_bodies_are_symmetric_whatever_the_pose(name: str, real_mesh: Callable[[str], Mesh]):
    body = name.split("/")[0]
    vertices, faces = real_mesh(f"{name}.obj")
    partner = true_partners(real_mesh(f"{body}/{REST[body]}.obj")[0])
    areas, unit = vertex_areas(vertices, faces), np.sqrt(surface_area(vertices, faces))
    held, free = (canonical_form(vertices, faces, Settings(symmetry=how)) for how in ("hold", "ignore"))
    apart = [asymmetry(form.vertices, partner, areas) / unit for form in (held, free)]
    assert apart[0] < 0.035
    assert apart[0] < 0.9 * apart[1]
    assert held.asymmetry < 0.025
    assert np.isnan(free.asymmetry)


def test_a_body_with_one_long_arm_has_no_left_and_right(figure: Mesh):
    vertices, faces = figure
    tip = np.argmax(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1))
    way = vertices[tip] - vertices.mean(axis=0)
    near = np.exp(-((np.linalg.norm(vertices - vertices[tip], axis=1) / np.linalg.norm(way)) ** 4) * 8)
    lopsided = vertices + 1.5 * near[:, None] * way
    assert np.isnan(canonical_form(lopsided, faces).asymmetry)


def test_a_snake_of_two_ends_may_be_mirrored():
    vertices, faces = shapes.joint(60)
    assert canonical_form(vertices, faces).asymmetry < 0.02
