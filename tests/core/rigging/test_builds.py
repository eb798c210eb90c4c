"""The mannequin in other proportions, and the choice among builds: the one whose skeleton explains the skin."""

import numpy as np
import pytest

from addon.core import KeptStages, Settings, mannequin, stance_by_match
from addon.core.matches import unfolded_pair
from addon.core.rigging.candidates import candidates
from addon.core.rigging.evidence import trunk_axes
from addon.core.rigging.proportions import BUILDS, reshaped, scales_of
from addon.core.rigging.reference_rig import mannequin_rig
from addon.core.rigging.references import adult, other_builds
from addon.core.run.monitor import Monitor


@pytest.fixture(scope="module")
def rig():
    return mannequin_rig(*mannequin())


def long(rig, name):
    bone = rig.skeleton.names.index(name)
    return float(np.linalg.norm(rig.skeleton.tails[bone] - rig.skeleton.heads[bone]))


@pytest.mark.parametrize("build", BUILDS.values(), ids=BUILDS)
def test_bones_are_as_long_as_the_build_says_and_joined(rig, build):
    other = reshaped(rig, scales_of(rig, build))
    for name, part in (("spine.006", "head"), ("forearm.R", "arm"), ("thigh.L", "leg"), ("spine.001", "trunk")):
        assert long(other, name) == pytest.approx(build[part][0] * long(rig, name))
    for bone, above in enumerate(rig.skeleton.parents):
        if above >= 0 and np.allclose(rig.skeleton.heads[bone], rig.skeleton.tails[above]):
            assert np.allclose(other.skeleton.heads[bone], other.skeleton.tails[above])
    mirrored = other.skeleton.heads[rig.mates] * [-1.0, 1, 1]
    assert np.allclose(mirrored, other.skeleton.heads)
    assert np.array_equal(other.faces, rig.faces)


def test_no_change_of_proportions_changes_nothing(rig):
    same = reshaped(rig, scales_of(rig, {}))
    assert np.allclose(same.vertices, rig.vertices)
    assert np.allclose(same.skeleton.tails, rig.skeleton.tails)


@pytest.fixture(scope="module")
def chibi(rig):
    """A figure that is half head, turned by a quarter, with its own skeleton's joints."""
    other = reshaped(rig, scales_of(rig, BUILDS["chibi"]))
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    return other, other.vertices @ turn.T, other.skeleton.heads @ turn.T


def test_a_large_head_is_fitted_by_another_build(rig, chibi):
    _, vertices, joints = chibi
    monitor, settings = Monitor(), Settings()
    pair = unfolded_pair(vertices, rig.faces, rig.vertices, rig.faces, settings, monitor, 1.0)
    whole, asked = adult(rig, pair.other_surfaces[0], np.arange(len(rig.vertices))), []

    def builds():
        asked.append(True)
        return other_builds(whole, settings, monitor)

    found = candidates(pair.surfaces[0], whole, builds, monitor)
    assert asked
    head = rig.skeleton.names.index("spine.006")
    assert long(found[0].reference.rig, "spine.006") > 2 * long(rig, "spine.006")
    own = pair.surfaces[0].found
    heads = found[0].fit.bones.heads * own.unit + own.centre
    height = np.ptp(vertices[:, 2])
    assert np.linalg.norm(heads - joints, axis=1).mean() / height < 0.02
    assert np.linalg.norm(heads[head] - joints[head]) / height < 0.03
    assert np.allclose(trunk_axes(rig, found[0].fit.bones)[0], [0, 1, 0], atol=0.1)


def test_an_adult_is_not_compared_with_other_builds(rig):
    pair = unfolded_pair(rig.vertices, rig.faces, rig.vertices, rig.faces, Settings(), Monitor(), 1.0)
    whole = adult(rig, pair.other_surfaces[0], np.arange(len(rig.vertices)))
    found = candidates(pair.surfaces[0], whole, lambda: pytest.fail("other builds were asked for"), Monitor())
    assert found[0].residual < 0.01
    assert [each.cost for each in found] == sorted(each.cost for each in found)


def test_a_kept_fit_is_not_computed_again(rig, monkeypatch):
    vertices = mannequin(40.0)[0]
    keep = KeptStages()
    first = stance_by_match(vertices, rig.faces, keep=keep)
    monkeypatch.setattr("addon.core.rigs.candidates", lambda *_: pytest.fail("fitted again"))
    monkeypatch.setattr("addon.core.rigs.unfolded_pair", lambda *_, **__: pytest.fail("unfolded again"))
    other = stance_by_match(vertices, rig.faces, side=1, anyway=True, keep=keep)
    again = stance_by_match(vertices, rig.faces, side=0, keep=keep)
    assert np.array_equal(again.vertices, first.vertices)
    assert again.match.sides == other.match.sides == first.match.sides
    middle = first.vertices[:, 0].mean()
    left = first.vertices[:, 0] > middle + 0.1
    assert (other.vertices[left, 0] < middle).mean() > 0.9  # turned back to front


def test_what_is_kept_is_of_this_mesh_and_cannot_be_changed_from_outside(rig):
    vertices, settings = mannequin(40.0)[0], Settings(quality="draft")
    keep, own = KeptStages(), vertices.copy()
    first = stance_by_match(own, rig.faces, settings, keep=keep)
    height = np.ptp(first.vertices[:, 2])
    first.vertices[:] *= 100
    own *= 3
    again = stance_by_match(vertices, rig.faces, settings, keep=keep)
    assert np.ptp(again.vertices[:, 2]) == pytest.approx(height)
    larger = stance_by_match(2 * vertices, rig.faces, settings, keep=keep)
    assert np.ptp(larger.vertices[:, 2]) == pytest.approx(2 * height, rel=1e-3)
    prop = np.array([[3.0, 0, 0], [3, 0.1, 0], [3, 0, 0.1], [3.1, 0, 0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    more = np.concatenate([rig.faces, faces + len(vertices)])
    joined = stance_by_match(np.concatenate([vertices, prop]), more, settings, keep=keep)
    assert joined.vertices.shape == (len(vertices) + 4, 3)
