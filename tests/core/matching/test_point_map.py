"""From the map of the vertices that are worked on to one of all vertices."""

import numpy as np
import pytest

from addon.core.matching import point_map as module
from addon.core.matching.point_map import point_map
from addon.core.matching.sides import sides
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.closest_points import closest_points
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor
from tests.meshes import shapes


def confidence(one, other, partner, places):
    return module._confidence(one, other, partner, places, np.eye(3), Monitor())


def distance_home(one, other, partner):
    back = module.refined(other, one, module._first_back(other, partner), module._BACK, module._NEAR, Monitor())
    return np.linalg.norm(one.form[back[partner]] - one.form, axis=1)


def test_a_body_is_matched_with_itself_vertex_by_vertex_and_surely(body, renumbered):
    other, old = renumbered
    side = sides(body, other, Monitor())[0]
    found = point_map(body, other, side, Monitor())
    reached = np.einsum(
        "ij,ijk->ik", found.points.weights, other.whole_form[other.found.whole_faces[found.points.faces]]
    )
    back = np.argsort(old)
    rotation, shift = rigid_fit(body.whole_form, other.whole_form[back])
    np.testing.assert_allclose(reached, body.whole_form @ rotation + shift, atol=1e-4)
    assert found.confidence.min() > 0.99
    assert found.score == side.score


@pytest.mark.parametrize(("score", "rounds"), [(-5.0, [(21, 120)]), (-3.0, [(5, 60), (11, 120)])])
def test_unlike_bodies_take_half_the_rounds_after_a_rough_map_that_tells_areas(body, monkeypatch, score, rounds):
    """Each round slides a trunk a little, which poses of a body make up for."""
    taken = []

    def counting(one, other, partner, counts, *given):
        taken.append(list(counts))
        return module_refined(one, other, partner, counts, *given)

    module_refined = module.refined
    monkeypatch.setattr(module, "refined", counting)
    point_map(body, body, sides(body, body, Monitor())[0]._replace(score=score), Monitor())
    *there, back = taken
    assert [(len(counts), counts[-1]) for counts in there] == rounds
    assert {counts[0] for counts in there} == {20}
    assert back == [110, 120]
    taken.clear()
    module.working_map(body, body, sides(body, body, Monitor())[0]._replace(score=score), Monitor())
    assert [len(counts) for counts in taken] == [rounds[-1][0], 2]  # a mannequin is fitted to skin that may be fused


def test_where_a_limb_has_no_like_the_match_is_unsure(gathered, body):
    """The same body with a limb cut off: nothing there is sure, and much elsewhere is."""
    vertices, faces = shapes.figure(15)
    limb = vertices[:, 0] > np.quantile(vertices[:, 0], 0.85)
    left, corners = np.unique(faces[~limb[faces].any(axis=1)], return_inverse=True)
    other = gathered(vertices[left], corners.reshape(-1, 3))
    found = point_map(body, other, sides(body, other, Monitor())[0], Monitor())
    assert found.confidence.min() >= 0
    assert found.confidence[limb].mean() < 0.6 * found.confidence[~limb].mean()
    assert found.confidence[~limb].mean() > 0.5


def test_the_confidence_is_smoothed_by_one_step_of_the_heat_flow(body, monkeypatch):
    """For a time of 2e-4 of the area: (M + t L) x = M c."""
    rough = np.random.default_rng(0).uniform(0.3, 0.7, len(body.form))
    monkeypatch.setattr(module, "_confidence", lambda *given: rough)
    sure = point_map(body, body, sides(body, body, Monitor())[0], Monitor()).confidence
    mass, flow = body.found.mass, 2e-4 * body.found.mass.sum() * body.found.stiffness
    assert np.ptp(sure) < 0.9 * np.ptp(rough)
    np.testing.assert_allclose(mass * sure + flow @ sure, mass * rough, atol=1e-9 * mass.max())


def test_nothing_is_less_sure_on_the_map_to_itself(body):
    every = np.arange(len(body.form))
    np.testing.assert_allclose(confidence(body, body, every, body.form), 1.0, atol=1e-9)


@pytest.mark.parametrize("factor", [0.6, 1.2, 2.0])
def test_areas_that_change_by_three_count_as_wrong(body, factor):
    sure = confidence(body, body, np.arange(len(body.form)), factor * body.form)
    np.testing.assert_allclose(sure, np.exp(-((2 * np.log(factor) / np.log(3)) ** 2)), rtol=1e-9)


@pytest.mark.parametrize(
    ("cosine", "expected"), [(0.9, 0.8**0.5), (0.6, 0.2**0.5), (0.5, 0.0), (0.1, 0.0), (-1.0, 0.0)]
)
def test_normals_that_disagree_make_it_less_sure(body, cosine, expected):
    across = np.cross(body.normals, np.roll(body.normals, 1, axis=1) + np.array([0.1, 0.2, 0.3]))
    across /= np.linalg.norm(across, axis=1)[:, None]
    other = body._replace(normals=cosine * body.normals + np.sqrt(1 - cosine**2) * across)
    every = np.arange(len(body.form))
    home = distance_home(body, other, every)
    np.testing.assert_allclose(
        confidence(body, other, every, body.form), expected * np.exp(-((home / 0.08) ** 2)), atol=1e-7
    )


def without_area_at(body, tip):
    """Places of the vertices, with all triangles at one of them drawn together into it."""
    places = body.form.copy()
    places[np.unique(body.faces[(body.faces == tip).any(axis=1)])] = places[tip]
    return places


def test_where_the_triangles_end_without_area_the_map_is_not_sure(body):
    tip = int(body.features[0])
    sure = confidence(body, body, np.arange(len(body.form)), without_area_at(body, tip))
    assert sure[tip] == 0.0
    assert np.isfinite(sure).all()


def test_where_the_triangles_begin_without_area_the_confidence_is_a_number(body):
    flat = body._replace(form=without_area_at(body, int(body.features[0])))
    assert np.isfinite(confidence(flat, body, np.arange(len(body.form)), body.form)).all()


def test_triangles_turned_over_count_by_their_share(body):
    places = body.form.copy()
    tip = int(body.features[0])
    beside = np.setdiff1d(body.faces[(body.faces == tip).any(axis=1)], tip)
    centre = body.form[beside].mean(axis=0)
    normal = body.normals[beside].mean(axis=0)
    places[tip] = centre - 0.5 * normal / np.linalg.norm(normal)  # through the surface and far out
    every = np.arange(len(body.form))
    before, after = (np.cross(at[body.faces[:, 1]] - at[body.faces[:, 0]], at[body.faces[:, 2]] - at[body.faces[:, 0]])
                     for at in (body.form, places))  # fmt: skip
    kept = (before * after).sum(axis=1) > 0
    assert 0 < (~kept).sum() < 12
    share = np.array([kept[(body.faces == vertex).any(axis=1)].mean() for vertex in every])
    grown = np.zeros(len(every))
    for vertex in every:
        here = (body.faces == vertex).any(axis=1)
        grown[vertex] = np.log(np.linalg.norm(after[here], axis=1).sum() / np.linalg.norm(before[here], axis=1).sum())
    expected = share * np.exp(-((grown / np.log(3)) ** 2))
    np.testing.assert_allclose(confidence(body, body, every, places), expected, atol=1e-9)


def test_ways_back_that_end_elsewhere_make_it_less_sure(body):
    """Half of the vertices go to one of their neighbours: they come home to where that is."""
    every = np.arange(len(body.form))
    partner = every.copy()
    neighbour = dict(body.faces[:, :2].tolist() + body.faces[:, 1:].tolist())
    for vertex in every[::2]:
        partner[vertex] = neighbour[vertex]
    home = distance_home(body, body, partner)
    facing = np.einsum("ij,ij->i", body.normals, body.normals[partner])
    expected = np.exp(-((home / 0.08) ** 2)) * np.sqrt(np.clip(2 * facing - 1, 0, 1))
    assert expected.min() < 0.9
    np.testing.assert_allclose(confidence(body, body, partner, body.form), expected, atol=1e-9)


def test_the_way_back_begins_where_the_nearest_mapped_vertex_comes_from(body):
    some = np.arange(0, len(body.form), 5)
    begin = module._first_back(body, some)
    apart = np.linalg.norm(body.form[:, None] - body.form[some], axis=2)
    np.testing.assert_array_equal(begin, apart.argmin(axis=1))


def test_it_can_be_cancelled(body, monkeypatch):
    side = sides(body, body, Monitor())[0]
    handed = []

    def spy(points, faces, wanted, monitor):
        handed.append(monitor)
        return closest_points(points, faces, wanted, monitor)

    monkeypatch.setattr(module, "closest_points", spy)
    monitor = Monitor()
    point_map(body, body, side, monitor)
    assert handed == [monitor]
    with pytest.raises(CancelledError):
        point_map(body, body, side, Monitor(cancelled=lambda: True))
