import numpy as np
import pytest

from addon.core import pose_like
from addon.core.measures.crossings import crossings
from addon.core.mesh.geometry import signed_volume
from addon.core.posing import untangling
from addon.core.posing.untangling import untangled
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor
from tests.meshes import shapes

DEEP = 1.9  # distance of the centres of two balls of radius 1


@pytest.fixture(scope="module")
def balls():
    """Two balls apart, and pushed into each other."""
    ball, faces = shapes.sphere(3)
    both = np.concatenate([faces, faces + len(ball)])
    aside = np.array([1.0, 0.07, 0.03])
    apart = np.concatenate([ball, ball + 3 * aside])
    return apart, np.concatenate([ball, ball + DEEP * aside]), both


def test_balls_that_meet_are_flattened_where_they_do(balls):
    apart, touching, faces = balls
    found = untangled(apart, touching, faces, Monitor())
    assert len(crossings(touching, faces)) > 20
    assert len(crossings(found, faces)) == 0
    moved = np.linalg.norm(found - touching, axis=1)
    assert 0.03 < moved.max() < 0.15  # either half of the overlap, and some
    assert (moved[np.abs(touching[:, 0] - DEEP / 2) > 0.5] == 0).all()
    for each in np.split(faces, 2):
        assert signed_volume(found, each) == pytest.approx(signed_volume(touching, each), rel=0.02)


def test_what_crossed_before_stays(balls):
    _, touching, faces = balls
    turned = touching @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]) + 5
    assert untangled(touching, turned, faces, Monitor()) is turned


def test_place_turn_and_size_do_not_matter(balls, rotation):
    apart, touching, faces = balls
    found = untangled(apart, touching, faces, Monitor())
    again = untangled(10 * apart, 10 * touching @ rotation + 3, faces, Monitor())
    np.testing.assert_allclose(again, 10 * found @ rotation + 3, atol=1e-6)


def test_open_surfaces_are_pulled_apart():
    sheet, faces = shapes.grid(20, 20)
    both = np.concatenate([faces, faces + len(sheet)])
    bump = 0.1 * np.exp(-40 * ((sheet[:, :2] - sheet[:, :2].mean(axis=0)) ** 2).sum(axis=1))
    raised = sheet.copy()
    raised[:, 2] += bump
    above = sheet + np.array([0.003, 0.002, 0.08])
    after = np.concatenate([raised, above])
    assert len(crossings(after, both)) > 5
    found = untangled(np.concatenate([sheet, above]), after, both, Monitor())
    assert len(crossings(found, both)) == 0


def test_a_body_folded_through_itself_is_left_alone():
    ball, faces = shapes.sphere(2)
    noise = np.random.default_rng(1).normal(size=ball.shape)
    assert untangled(ball, noise, faces, Monitor()) is noise


def test_it_can_be_cancelled(balls):
    apart, touching, faces = balls
    with pytest.raises(CancelledError):
        untangled(apart, touching, faces, Monitor(None, lambda: True))


def test_large_meshes_are_untangled_coarsely_first(balls, monkeypatch):
    apart, touching, faces = balls
    fine, fine_faces = shapes.midpoints(apart, faces)
    pushed, _ = shapes.midpoints(touching, faces)
    monkeypatch.setattr(untangling, "_LARGE", len(fine) - 1)
    monkeypatch.setattr(untangling, "_COARSE", len(apart) // 2)
    found = untangled(fine, pushed, fine_faces, Monitor())
    assert len(crossings(pushed, fine_faces)) > 40
    assert len(crossings(found, fine_faces)) == 0
    monkeypatch.setattr(untangling, "_ROUNDS", 0)
    assert len(crossings(untangled(fine, pushed, fine_faces, Monitor()), fine_faces)) > 40


def test_a_transferred_pose_has_no_new_crossings(monkeypatch):
    """Of a limb bent so far that its two ends would pass through each other."""
    straight, faces = shapes.joint(0, radius=0.3)
    bent, _ = shapes.joint(184, radius=0.3)
    found = pose_like(straight, faces, straight, faces, reference_pose=bent)
    monkeypatch.setattr(untangling, "_ROUNDS", 0)
    without = pose_like(straight, faces, straight, faces, reference_pose=bent)
    assert len(crossings(without.vertices, faces)) > 50
    assert len(crossings(found.vertices, faces)) == 0
