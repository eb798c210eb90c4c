"""Pieces that ride on moving ground."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core.assembly import riding as module
from addon.core.assembly.contacts import sampled
from addon.core.assembly.pieces import Piece
from addon.core.assembly.riding import Ground, ground_of, is_rigid, ridden
from addon.core.run.monitor import Monitor
from tests.meshes import shapes

TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()


def plate(size, cells=24, x=0.0, y=0.0, z=0.0):
    """A square plate around a point."""
    vertices, faces = shapes.grid(cells, cells, size, size)
    return vertices - [size / 2, size / 2, 0] + np.array([x, y, z]), faces


def moved(rider, ground, *, rigid):
    """Where a rider goes, and what was warned of."""
    monitor = Monitor()
    points, faces = rider
    piece = Piece(np.arange(len(points)), points, faces)
    (shape,) = ridden([piece], [sampled(points, faces)], ground, rigid=rigid, monitor=monitor)
    return shape, [warning.kind for warning in monitor.warnings]


def ground_under(mapping, size=1.0):
    """A dense plate and where a mapping of points takes it."""
    points, faces = plate(size, 40)
    samples = sampled(points, faces, 0.005)
    return Ground(samples.points, mapping(samples.points))


def bent(points, radius=0.3):
    """Roll the plane up along x: lengths are kept, and so are heights over it."""
    angle, height = points[:, 0] / radius, radius - points[:, 2]
    return np.column_stack([height * np.sin(angle), points[:, 1], radius - height * np.cos(angle)])


@pytest.mark.parametrize("rigid", [True, False])
def test_a_rider_goes_with_ground_that_moves_as_one(rigid):
    rider = plate(0.3, 12, 0.05, 0.02, 0.01)
    shape, warnings = moved(rider, ground_under(lambda points: points @ TURN + 2), rigid=rigid)
    np.testing.assert_allclose(shape, rider[0] @ TURN + 2, atol=1e-6)
    assert warnings == []


def test_a_cloth_follows_ground_that_bends_under_all_of_it():
    rider = plate(0.4, 16, 0.0, 0.0, 0.008)
    shape, warnings = moved(rider, ground_under(bent), rigid=False)
    assert warnings == []
    off = np.linalg.norm(shape - bent(rider[0]), axis=1)
    assert np.quantile(off, 0.95) < 0.004
    assert off.max() < 0.012


def test_a_button_keeps_its_shape_and_turns_with_what_is_under_it():
    rider = plate(0.05, 4, 0.15, 0.0, 0.008)
    shape, warnings = moved(rider, ground_under(bent), rigid=True)
    assert warnings == []
    edges = rider[1][:, :2]
    np.testing.assert_allclose(
        np.linalg.norm(np.subtract(*shape[edges.T]), axis=1), np.linalg.norm(np.subtract(*rider[0][edges.T]), axis=1)
    )
    assert np.abs(shape - bent(rider[0])).max() < 0.002


def test_what_lies_nearest_moves_a_rigid_rider_most():
    """A wedge that stands on its edge: the ground bends away under its other end, which is higher."""
    points, faces = plate(0.1, 10, 0.05, 0.0, 0.0)
    rider = points + np.column_stack([0 * points[:, :2], 0.25 * points[:, 0]]), faces
    shape, _ = moved(rider, ground_under(lambda points: bent(points, 0.1)), rigid=True)
    edge = rider[0][:, 0] < 1e-9
    off = np.linalg.norm(shape - bent(rider[0], 0.1), axis=1)
    assert off[edge].max() < 0.004
    assert off[~edge].max() > 0.01


def test_ground_of_another_limb_does_not_count():
    """Beside a line the ground folds over, and distances from where the rider stands hardly change."""

    def folded(points):
        over = points[:, 0] > 0.01
        away = points[:, 0] - 0.01
        turned = np.column_stack([0.01 + away * np.cos(1.0), points[:, 1], points[:, 2] + away * np.sin(1.0)])
        return np.where(over[:, None], turned, points)

    rider = plate(0.02, 4, 0.0, 0.0, 0.004)
    shape, _ = moved(rider, ground_under(folded), rigid=True)
    assert np.abs(shape - rider[0]).max() < 1e-3


def test_a_cloth_that_cannot_follow_goes_as_one_and_it_is_told():
    """The ground tears, and what lies on both sides would be stretched."""
    rider = plate(0.2, 24, 0.0, 0.0, 0.004)
    torn = ground_under(lambda points: points + np.where(points[:, :1] > 0, 3.0, 0.0) * [1.0, 0, 0])
    shape, warnings = moved(rider, torn, rigid=False)
    assert warnings == ["rider_stretched"]
    edges = rider[1][:, :2]
    np.testing.assert_allclose(
        np.linalg.norm(np.subtract(*shape[edges.T]), axis=1), np.linalg.norm(np.subtract(*rider[0][edges.T]), axis=1)
    )


def test_the_ground_is_the_samples_of_all_its_pieces():
    points, faces = plate(1.0, 8)
    samples = [sampled(points, faces, 0.1), sampled(points + 2, faces, 0.1)]
    ground = ground_of(samples, [points @ TURN, (points + 2) @ TURN])
    np.testing.assert_allclose(ground.after, ground.before @ TURN)
    assert len(ground.before) == sum(len(each.points) for each in samples)


@pytest.mark.parametrize(
    ("count", "half", "area", "covered", "expected"),
    [
        (24, 0.061, 0.01, 0.5, False),
        (23, 0.061, 0.01, 0.5, True),
        (24, 0.059, 0.01, 0.5, True),
        (24, 0.061, 0.0039, 0.5, True),
        (24, 0.061, 0.01, 0.29, True),
    ],
)
def test_small_pieces_and_loose_ones_are_rigid(count, half, area, covered, expected):
    """Half the diagonal counts, wherever the piece is."""
    points = np.random.default_rng(0).uniform(size=(count, 3)) * [3.0, 2, 1]
    points[:2] = [[0, 0, 0], [3, 2, 1]]
    points *= 2 * half / np.sqrt(14)
    assert is_rigid(points, area, covered) is expected
    assert is_rigid(points + np.array([7.0, -3, 0]), area, covered) is expected


def test_a_cloth_hands_its_monitor_on(monkeypatch):
    """A large cloth is made coarse first, and a cancel ends that too."""
    handed = []

    def spy(points, faces, target, *, monitor):
        handed.append(monitor)
        return reduce(points, faces, target, monitor=monitor)

    reduce = module.working_surface
    monkeypatch.setattr(module, "working_surface", spy)
    points, faces = plate(0.4, 16, 0.0, 0.0, 0.008)
    monitor = Monitor()
    piece = Piece(np.arange(len(points)), points, faces)
    ridden([piece], [sampled(points, faces)], ground_under(bent), rigid=False, monitor=monitor)
    assert handed == [monitor]


def test_a_cloth_gives_way_to_a_wave_of_the_ground_as_its_stiffness_allows(monkeypatch):
    """Where a cloth of unit area is to stretch by a wave cos(kx), it does so by the share p / (p + k²), p = 60."""
    seen = []

    def spy(body, target, *options, **others):
        seen.append((body.points, target, towards(body, target, *options, **others)))
        return seen[-1][2]

    towards = module.ElasticBody.towards
    monkeypatch.setattr(module.ElasticBody, "towards", spy)

    def stretched(points):
        return points + np.column_stack([0.01 * np.cos(np.pi * (points[:, 0] / 0.4 + 0.5)), 0 * points[:, 1:]])

    moved(plate(0.4, 24, 0.0, 0.0, 0.008), ground_under(stretched), rigid=False)
    ((points, target, placed),) = seen
    wave = np.cos(np.pi * (points[:, 0] - points[:, 0].min()))
    asked, given = ((each[:, 0] - points[:, 0]) @ wave for each in (target, placed))
    assert given / asked == pytest.approx(60 / (60 + np.pi**2), rel=0.01)
