"""Landmarks that push each other apart."""

import numpy as np
import pytest

from addon.core.embedding.pushing import LinkStress, Pushing
from addon.core.mesh.edges import vertex_pairs
from addon.core.mesh.geometry import surface_area
from tests.meshes import shapes


def test_links_are_a_stress_and_its_gradient():
    rng = np.random.default_rng(0)
    points, way = rng.normal(size=(2, 30, 3))
    links = np.array([(i, j) for i in range(30) for j in range(i + 1, 30)])[::3]
    targets, weights = rng.uniform(0.5, 2, (2, len(links)))
    stress = LinkStress(links, targets, weights, 30)
    value, pull = stress.value_and_descent(points)
    naive = sum(w * (t - np.linalg.norm(points[i] - points[j])) ** 2
                for (i, j), t, w in zip(links, targets, weights, strict=True))  # fmt: skip
    assert value == pytest.approx(naive, rel=1e-12)
    above, below = (stress.value_and_descent(points + s * 1e-6 * way)[0] for s in (1, -1))
    assert np.vdot(pull, way) == pytest.approx(-(above - below) / 4e-6, rel=1e-5)


def test_pushing_apart_straightens_a_bent_tube():
    vertices, faces = shapes.bent_tube()
    vertices = vertices / np.sqrt(surface_area(vertices, faces))
    samples = np.arange(0, len(vertices), 20)
    pushing = Pushing(vertices, vertex_pairs(faces), samples, strength=0.5)
    form, history = pushing.lowered(vertices, tolerance=1e-6, max_iterations=2000)
    assert (np.diff(history) <= 0).all()
    i, j = vertex_pairs(faces).T
    kept = np.linalg.norm(form[i] - form[j], axis=1) / np.linalg.norm(vertices[i] - vertices[j], axis=1)
    assert np.median(np.abs(kept - 1)) < 0.12
    ends = np.linalg.norm(np.ptp(form, axis=0)), np.linalg.norm(np.ptp(vertices, axis=0))
    assert ends[0] > 1.2 * ends[1]


def test_a_push_without_depth_leaves_the_third_axis_alone():
    vertices, faces = shapes.bent_tube()
    vertices = vertices / np.sqrt(surface_area(vertices, faces))
    pushing = Pushing(vertices, vertex_pairs(faces), np.arange(0, len(vertices), 20), strength=3.0, depth=0.0)
    flat = vertices * [1.0, 1.0, 0.0]
    assert np.abs(pushing.lowered(flat, max_iterations=20)[0][:, 2]).max() < 1e-12


def test_tips_share_the_push_and_each_gets_as_much():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 2, 0], [3, 0, 0]])
    samples, tips = np.array([0, 1]), [np.array([2, 3]), np.array([1, 4])]
    pushing = Pushing(points, np.array([[0, 1]]), samples, strength=1.0, tips=tips, tip_share=0.5)
    far, away = 10.0, lambda i, j: np.linalg.norm(points[i] - points[j])
    half = [np.mean([(far - away(i, j)) ** 2 for i in tip for j in np.setdiff1d(samples, tip)]) for tip in tips]
    wanted = (0.5 * (far - away(0, 1)) ** 2 + 0.5 * np.mean(half)) / far
    assert pushing.value_and_descent(points)[0] == pytest.approx(wanted, rel=1e-12)
