"""Where forms lie: upright, and on a reference."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core import InvalidSettingsError, Settings, canonical_form, mannequin
from addon.core.matching.laying import CLOSE, laid_by_limbs
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.coarsening import coarsened
from addon.core.mesh.geometry import surface_area, vertex_areas
from addon.core.placing.reference import reference_bodies
from addon.core.run.monitor import Monitor
from addon.core.symmetry.limbs import limbs_of
from tests.meshes import shapes

UPRIGHT = Settings(orientation="upright", quality="draft")
DRAFT = Settings(quality="draft")


Mesh = tuple[np.ndarray, np.ndarray]


def form_of(mesh: Mesh, settings: Settings, **how):
    return canonical_form(mesh[0], mesh[1], settings, **how)


def angle_between(one, two, weights):
    return np.degrees(Rotation.from_matrix(rigid_fit(one, two, weights)[0]).magnitude())


@pytest.fixture(scope="module")
def bear(real_mesh) -> dict[str, Mesh]:
    return {pose: real_mesh(f"bear/{pose}.obj") for pose in ("bind", "bear_run_f12", "bear_walk_f18")}


def test_an_upright_form_does_not_hang_on_how_the_mesh_lies(real_mesh, rotation):
    vertices, faces = real_mesh("horse/horse_gallop_f00.obj")
    form = canonical_form(vertices, faces, UPRIGHT).vertices
    turned = canonical_form(vertices @ rotation + [3.0, -1, 2], faces, UPRIGHT).vertices
    centre, other = form.mean(axis=0), turned.mean(axis=0)
    np.testing.assert_allclose(turned - other, form - centre, atol=1e-6 * float(np.ptp(form)))


@pytest.mark.parametrize(
    ("name", "up", "ahead"), [("man/dance1_00", [0, 1, 0], [0, 0, 1]), ("horse/horse_trot_f06", [0, 1, 0], [0, 0, -1])]
)
def test_bodies_stand_on_their_feet_and_face_the_viewer(name, up, ahead, real_mesh):
    rest = {"man": "man/rest", "horse": "horse/bind"}[name.split("/")[0]]
    vertices, faces = real_mesh(f"{name}.obj")
    standing = real_mesh(f"{rest}.obj")[0]  # whose up and ahead are known
    form = canonical_form(vertices, faces, UPRIGHT).vertices
    to_standing, _ = rigid_fit(form, standing, vertex_areas(vertices, faces))
    assert np.array([0, 0, 1]) @ to_standing @ up > 0.9
    assert np.array([0, -1, 0]) @ to_standing @ ahead > 0.9


def test_poses_of_a_body_stand_alike(bear):
    forms = [form_of(mesh, UPRIGHT).vertices for mesh in bear.values()]
    weights = vertex_areas(*bear["bind"])
    assert max(angle_between(forms[0], each, weights) for each in forms[1:]) < 5


def test_the_stance_can_be_chosen(real_mesh):
    vertices, faces = real_mesh("bear/bind.obj")
    up = canonical_form(vertices, faces, replace(UPRIGHT, orientation="two_legs")).vertices
    down = canonical_form(vertices, faces, replace(UPRIGHT, orientation="all_fours")).vertices
    np.testing.assert_allclose(up - up.mean(axis=0), (down - down.mean(axis=0)) @ [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    upright = canonical_form(vertices, faces, UPRIGHT).vertices
    np.testing.assert_array_equal(upright, down)


@pytest.mark.parametrize("make", [lambda: shapes.sphere(3), lambda: shapes.joint(60), lambda: shapes.figure()])
def test_bodies_of_any_kind_can_stand(make):
    vertices, faces = make()
    form = canonical_form(vertices, faces, UPRIGHT)
    assert np.isfinite(form.vertices).all()
    assert surface_area(form.vertices, faces) == pytest.approx(surface_area(vertices, faces))


def test_every_method_can_stand(figure):
    vertices, faces = figure
    for method in ("classical", "euclidean_normalised", "skeleton"):
        assert np.isfinite(canonical_form(vertices, faces, replace(UPRIGHT, method=method)).vertices).all()


def test_a_form_is_laid_onto_that_of_another_pose(bear):
    reference = form_of(bear["bind"], DRAFT)
    weights = vertex_areas(*bear["bind"])
    for pose in ("bear_run_f12", "bear_walk_f18"):
        form = form_of(bear[pose], DRAFT, reference=reference)
        rotation, shift = rigid_fit(form.vertices, reference.vertices, weights)
        apart = [
            np.sqrt(weights @ ((each - reference.vertices) ** 2).sum(axis=1))
            for each in (form.vertices, form.vertices @ rotation + shift)
        ]
        assert apart[0] < 1.1 * apart[1]
        assert surface_area(form.vertices, form.faces) == pytest.approx(surface_area(*bear[pose]))
        assert not form.warnings


@pytest.mark.parametrize("pose", ["dance1_00", "walk1_04"])
def test_a_form_is_laid_onto_that_of_another_mesh_of_the_body(real_mesh, pose):
    rest, faces = real_mesh("man/rest.obj")
    reference = canonical_form(rest, faces)
    vertices, _ = real_mesh(f"man/{pose}.obj")
    coarse = coarsened(vertices, faces, 7000)
    order = np.random.default_rng(0).permutation(len(coarse.kept))
    form = canonical_form(vertices[coarse.kept][order], np.argsort(order)[coarse.faces], reference=reference)
    there = reference.vertices[coarse.kept][order]
    assert angle_between(form.vertices, there, np.ones(len(there))) < 5
    tips = rest[coarse.kept][order][form.feature_points]
    nearest = np.linalg.norm(tips[:, None] - rest[reference.feature_points], axis=2).argmin(axis=1)
    assert nearest.tolist() == [0, 1, 2, 3, 4]
    assert form.warnings == []


def test_a_form_that_may_as_well_lie_the_other_way_round_is_told(real_mesh):
    rest, faces = real_mesh("woman/rest.obj")
    vertices, _ = real_mesh("woman/benchmark_00.obj")
    coarse = coarsened(vertices, faces, 7000)
    form = canonical_form(vertices[coarse.kept], coarse.faces, reference=canonical_form(rest, faces))
    assert [each.kind for each in form.warnings] == ["reference_sides"]


def test_limbs_are_numbered_as_in_the_reference(bear):
    reference = form_of(bear["bind"], DRAFT)
    (body,) = reference.bodies
    order = np.array([2, 0, 4, 1, 3])
    other = replace(
        reference,
        feature_points=reference.feature_points[order],
        bodies=[body._replace(tips=body.tips[order], limbs=body.limbs.sorted_by(order))],
    )
    form = form_of(bear["bear_walk_f18"], DRAFT, reference=other)
    plain = form_of(bear["bear_walk_f18"], DRAFT)
    np.testing.assert_array_equal(form.feature_points, plain.feature_points[order])
    np.testing.assert_array_equal(form.feature_points[form.patches], plain.feature_points[plain.patches])
    np.testing.assert_array_equal(form.bodies[0].limbs.adf, plain.bodies[0].limbs.adf[order])


def test_feature_points_chosen_by_hand_keep_their_order_on_a_reference(bear):
    reference = form_of(bear["bind"], DRAFT)
    chosen = tuple(int(each) for each in reference.feature_points[::-1])
    form = form_of(bear["bear_walk_f18"], replace(DRAFT, feature_points=chosen), reference=reference)
    assert tuple(form.feature_points) == chosen


def test_an_unlike_body_and_bodies_too_many_are_told(real_mesh, figure):
    man = form_of(real_mesh("man/rest.obj"), DRAFT)
    horse = form_of(real_mesh("horse/bind.obj"), DRAFT, reference=man)
    assert [warning.kind for warning in horse.warnings] == ["reference_unlike"]
    vertices, faces = figure
    two = np.concatenate([vertices, vertices + np.array([100.0, 0, 0])]), np.concatenate([faces, faces + len(vertices)])
    alone = canonical_form(vertices, faces, DRAFT)
    found = form_of(two, DRAFT, reference=alone)
    assert "reference_bodies" in [warning.kind for warning in found.warnings]
    np.testing.assert_allclose(found.vertices[: len(vertices)].mean(axis=0), alone.vertices.mean(axis=0), atol=0.2)
    assert found.vertices[len(vertices) :, 0].mean() > 90


@pytest.mark.parametrize("nose", [0.0, 0.6])
def test_a_form_that_may_lie_either_way_round_is_told(nose):
    tips = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 2, 0], [0, -1, 0]])
    points = np.concatenate([tips, np.linspace(0.1, 0.9, 9)[:, None, None] * tips], axis=None).reshape(-1, 3) / 3
    points = np.concatenate([points, points + np.array([0, 0, 0.01]), np.outer(np.linspace(0.1, 1, 20), [0, 0, nose])])
    far = np.linalg.norm(tips[:, None] - tips, axis=2)
    limbs = limbs_of(far, np.zeros((4, 4, 4)), np.ones(4), lambda: np.arange(4.0))
    laying = laid_by_limbs(points, points, np.arange(4), np.arange(4), limbs, limbs)
    assert laying.mismatch < 0.1
    assert (laying.rival < CLOSE) == (nose == 0)


def test_the_warning_reaches_the_form(figure, monkeypatch):
    monkeypatch.setattr(
        "addon.core.placing.orientation.laid_by_limbs",
        lambda *words, **how: laid_by_limbs(*words, **how)._replace(rival=0.0),
    )
    form = canonical_form(figure[0], figure[1], UPRIGHT)
    vertices, faces, _ = shapes.permuted(*figure)
    kinds = [each.kind for each in canonical_form(vertices, faces, DRAFT, reference=form).warnings]
    assert "reference_sides" in kinds


def test_a_reference_that_is_too_far_for_the_size_of_the_mesh_is_refused(figure):
    vertices, faces = figure
    reference = form_of(figure, DRAFT)
    with pytest.raises(InvalidSettingsError, match="too far from the origin"):
        canonical_form(1e-20 * vertices, faces, DRAFT, reference=reference)
    far = replace(reference, vertices=reference.vertices + 1e6)
    near = canonical_form(vertices, faces, DRAFT, reference=far).vertices
    np.testing.assert_allclose(near - 1e6, reference.vertices, atol=1e-6 * float(np.ptp(vertices)))


def test_a_form_without_limbs_is_no_reference(figure):
    with pytest.raises(InvalidSettingsError, match="Compute its form again"):
        form_of(figure, DRAFT, reference=replace(form_of(figure, DRAFT), bodies=[]))


def test_bodies_of_one_mesh_are_laid_onto_themselves_whatever_their_size(figure):
    vertices, faces = figure
    both = np.concatenate([faces, faces + len(vertices)])
    right = np.array([40.0, 0, 0])
    reference = canonical_form(np.concatenate([1.05 * vertices, vertices + right]), both, DRAFT)
    form = canonical_form(np.concatenate([vertices, 1.1 * vertices + right]), both, DRAFT, reference=reference)
    assert abs(form.vertices[: len(vertices), 0].mean()) < 5
    assert abs(form.vertices[len(vertices) :, 0].mean() - 40) < 5


def repaired(faces):
    """The triangles as another pose may have them: one fewer, one turned over, one at a copy of a vertex."""
    changed = faces[1:].copy()
    changed[0] = changed[0, ::-1]
    changed[5, 0] = faces[900, 0]
    return changed


def test_a_mesh_with_a_few_repaired_faces_is_still_the_same(figure):
    vertices, faces = figure
    form = canonical_form(vertices, faces, DRAFT)
    everything = [np.arange(len(vertices))]

    def is_same(faces, own=everything):
        (body,) = reference_bodies(form, faces, own, Monitor())
        assert body is not None
        return body.same_mesh

    assert is_same(faces)
    assert is_same(repaired(faces))
    assert is_same(repaired(faces), [np.setdiff1d(everything[0], form.faces[100])])
    assert not is_same(repaired(faces), [np.setdiff1d(everything[0], form.feature_points[:1])])
    assert not is_same(shapes.permuted(vertices, faces)[1])
    assert not is_same(faces, [np.arange(len(vertices) + 1)])  # vertices were added


def test_a_repaired_reference_holds_another_pose_by_its_vertices(figure, rotation):
    vertices, faces = figure
    form = canonical_form(vertices, faces, UPRIGHT)
    turned = canonical_form(vertices @ rotation, repaired(faces), DRAFT, reference=form)
    weights = vertex_areas(vertices, faces)
    assert angle_between(turned.vertices, form.vertices, weights) < 0.5
    np.testing.assert_array_equal(turned.feature_points, form.feature_points)
    assert not [each for each in turned.warnings if "reference" in each]


def test_many_like_limbs_are_told_apart_while_it_can_still_be_cancelled():
    vertices, faces = shapes.sphere(4)
    directions = shapes.sphere(1)[0][:30]
    spikes = np.exp(60 * (vertices @ directions.T - 1)).sum(axis=1)
    asked = 0

    def cancelled() -> bool:
        nonlocal asked
        asked += 1
        return False

    form = canonical_form(vertices * (1 + spikes)[:, None], faces, DRAFT, cancelled=cancelled)
    assert len(form.feature_points) > 20
    assert asked > 100


TURNS = [np.eye(3), np.diag([-1.0, -1, 1]), np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1]), np.eye(3)[[1, 2, 0]]]


@pytest.mark.parametrize("turn", TURNS)
def test_a_person_stands_and_faces_the_viewer_however_it_lies_in_the_file(turn):
    vertices, faces = mannequin(arms=40)
    form = canonical_form(vertices @ turn, faces, Settings(quality="draft", orientation="upright"))
    alike = [np.corrcoef(vertices[:, axis], form.vertices[:, axis])[0, 1] for axis in range(3)]
    assert min(alike) > 0.7
    told = [each.kind for each in form.warnings]
    assert ("upside_down" in told) == ((turn @ [0, 0, 1])[2] < -0.5)


@pytest.mark.parametrize("turn", TURNS[:4])
def test_what_the_surface_does_not_tell_is_as_in_the_file(turn):
    vertices, faces = mannequin(arms=40)
    ends = [int(each) for axis in (0, 2) for each in _ends(vertices, axis)]  # hands and feet: none is a head
    settings = Settings(quality="draft", orientation="two_legs", feature_points=ends)
    form = canonical_form(vertices @ turn, faces, settings)
    assert "upright_by_file" in [each.kind for each in form.warnings]
    assert np.corrcoef((vertices @ turn)[:, 2], form.vertices[:, 2])[0, 1] > 0.7


def _ends(vertices, axis):
    """The two hands, or the lowest vertex of either foot."""
    left = vertices[:, 0] > 0
    for side in (left, ~left):
        some = np.flatnonzero(side)
        yield some[np.argmax(np.abs(vertices[some, 0])) if axis == 0 else np.argmin(vertices[some, 2])]
