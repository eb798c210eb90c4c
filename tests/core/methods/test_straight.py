"""The default: limbs straight, with the lengths of the surface, left like right."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest

from addon.core import Settings, canonical_form
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.methods import straight
from tests.meshes import shapes, tubes
from tests.meshes.animals import giraffe
from tests.meshes.shapes import Mesh

AROUND = 24


def rings(vertices):
    """Centres and girths of the rings of a tube."""
    ring = vertices[: 60 * AROUND].reshape(60, AROUND, 3)
    girth = np.linalg.norm(ring - np.roll(ring, 1, axis=1), axis=2).sum(axis=1)
    return ring.mean(axis=1), girth


@pytest.mark.parametrize("degrees", [0, 60, 120, 175])
def test_a_bent_tube_comes_out_straight_and_as_long_and_wide_as_it_was(degrees: int):
    vertices, faces = shapes.joint(degrees, radius=0.25)
    form = canonical_form(vertices, faces).vertices
    centre, girth = rings(form)
    length = np.linalg.norm(np.diff(centre, axis=0), axis=1).sum()
    assert np.linalg.norm(centre[-1] - centre[0]) > 0.99 * length
    assert length == pytest.approx(4.0, rel=0.025)
    assert np.median(girth / rings(vertices)[1]) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("curve", [tubes.circle(90), tubes.circle(180), tubes.circle(270), tubes.double_bend])
def test_a_thin_tube_is_straight_up_to_its_ends_and_nowhere_narrow(curve: tubes.Curve):
    vertices, faces = tubes.tube(curve, AROUND, 160)
    centre, girth = tubes.rings(canonical_form(vertices, faces).vertices, AROUND)
    length = tubes.length_of(centre)
    assert np.linalg.norm(centre[-1] - centre[0]) > 0.995 * length
    assert length == pytest.approx(4.0, rel=0.015)
    np.testing.assert_allclose((girth / tubes.rings(vertices, AROUND)[1])[5:-5], 1.0, atol=0.03)


def test_poses_come_nearer_to_each_other_than_by_the_stress_of_the_paper(real_mesh: Callable[[str], Mesh]):
    meshes = [real_mesh(f"horse/{name}.obj") for name in ("bind", "horse_gallop_f00", "horse_idle_04_f76")]
    apart = []
    for method in ("local_features", "straight"):
        forms = [canonical_form(*mesh, Settings(method=method)).vertices for mesh in meshes]
        fits = [(one, two, *rigid_fit(one, two)) for one, two in combinations(forms, 2)]
        apart.append(np.mean([np.sqrt(((a @ turn + shift - b) ** 2).sum(axis=1).mean()) for a, b, turn, shift in fits]))
    assert apart[1] < 0.75 * apart[0]


@pytest.mark.parametrize("settings", [Settings(), Settings(symmetry="ignore")])
def test_edges_keep_their_lengths(settings):
    vertices, faces = shapes.figure(15)
    stretch = np.abs(edge_stretch(vertices, canonical_form(vertices, faces, settings).vertices, faces) - 1)
    assert np.median(stretch) < 0.05
    assert np.percentile(stretch, 99.9) < 0.5


def test_more_detail_keeps_more_of_the_edges_and_none_gives_the_arrangement_alone(figure: Mesh):
    vertices, faces = figure
    stretched = []
    for preserve in (0.0, 0.3, 0.5, 0.8, 1.0):
        form = canonical_form(vertices, faces, Settings(preserve_detail=preserve))
        stretched.append(np.percentile(np.abs(edge_stretch(vertices, form.vertices, faces) - 1), 95))
    assert stretched == sorted(stretched, reverse=True)
    assert stretched[-1] < 0.5 * stretched[1]
    assert stretched[0] < 0.2  # even without detail no limb is crumpled


def twist(form, limbs):
    """How far left to right of a pair of limbs is turned against that of another, about the line between: degrees."""
    left = np.flatnonzero(limbs.side > 0)
    one, other = (form[limbs.features[ends]] for ends in (left, limbs.partner[left]))
    middle, across, found = (one + other) / 2, one - other, [0.0]
    for i, j in combinations(range(len(left)), 2):
        axis = (middle[i] - middle[j]) / np.linalg.norm(middle[i] - middle[j])
        flat = [across[k] - across[k] @ axis * axis for k in (i, j)]
        lengths = np.prod([np.linalg.norm(each) for each in flat])
        found.append(float(np.degrees(np.arccos(np.clip(flat[0] @ flat[1] / lengths, -1, 1)))))
    return max(found)


def twisted(points):
    """Turn the front half of a shape half round its longest axis, against the other."""
    centred = points - points.mean(axis=0)
    along, y, z = (centred @ np.linalg.svd(centred, full_matrices=False)[2].T).T
    turn = np.pi * np.clip(along / (0.2 * along.std()) + 0.5, 0, 1)
    return np.column_stack([along, np.cos(turn) * y - np.sin(turn) * z, np.sin(turn) * y + np.cos(turn) * z])


@pytest.mark.parametrize("start", ["found", "twisted"])
def test_fore_and_hind_limbs_have_left_and_right_on_the_same_sides(start, monkeypatch):
    """From a layout whose trunk is twisted they would not: nothing turns it back."""
    if start == "twisted":
        found = straight.laid_out

        def laid_out(*given):
            layout = found(*given)
            return layout._replace(points=twisted(layout.points))

        monkeypatch.setattr(straight, "laid_out", laid_out)
    form = canonical_form(*giraffe(0.6, 40))
    limbs = form.bodies[0].limbs._replace(features=form.feature_points)
    assert np.count_nonzero(limbs.side > 0) >= 2
    assert (twist(form.vertices, limbs) < 15) == (start == "found")
