"""The angle at the joint of a limb, and how much of it a form has taken out."""

import numpy as np
import pytest

from addon.core import canonical_form
from addon.core.measures.limb_bends import bend_summary, limb_bends
from addon.core.mesh.geometry import vertex_areas
from tests.meshes import shapes


@pytest.mark.parametrize("degrees", [0, 30, 60, 90])
def test_the_angle_of_a_bent_tube(degrees):
    vertices, faces = shapes.joint(degrees, length=4.0, radius=0.2)
    straight = shapes.joint(0, length=4.0, radius=0.2)[0][:, :1].astype(float)
    mass, whole = vertex_areas(vertices, faces), np.zeros(len(vertices), dtype=np.int64)
    along = straight - straight.min()
    bend = float(limb_bends(vertices, mass, whole, along)[0])
    assert bend == pytest.approx(degrees, abs=0.2 * degrees + 1)  # the ends' centres lie close to a wide joint
    np.testing.assert_allclose(
        limb_bends(3.0 * np.roll(vertices, 1, axis=1) + 7.0, mass, whole, along), bend, atol=1e-9
    )


def test_a_ball_is_no_limb():
    vertices, faces = shapes.sphere(3)
    along = np.linalg.norm(vertices - vertices[0], axis=1)[:, None]
    whole = np.zeros(len(vertices), dtype=np.int64)
    assert np.isnan(limb_bends(vertices, vertex_areas(vertices, faces), whole, along)).all()
    assert bend_summary(np.full((3, 2), np.nan)) == {}


def test_a_form_says_how_far_its_limbs_were_bent():
    form = canonical_form(*shapes.figure())
    assert form.bends.shape == (len(form.feature_points), 2)
    told = bend_summary(form.bends)
    assert (told["limbs_bent"], told["limbs_straightened"]) == (3, 2)
    assert told["bend_in_form"] < told["bend_in_pose"] / 2


def test_limbs_of_several_bodies_have_the_numbers_of_their_points():
    vertices, faces = shapes.figure()
    mesh = np.vstack([vertices, vertices @ np.diag([-1, -1, 1]) + [9, 0, 0]]), np.vstack([faces, faces + len(vertices)])
    single, both = canonical_form(vertices, faces), canonical_form(*mesh)
    assert len(both.bodies) == 2
    for body in both.bodies:
        np.testing.assert_allclose(np.sort(both.bends[body.numbers, 0]), np.sort(single.bends[:, 0]), atol=0.5)
