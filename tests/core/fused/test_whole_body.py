"""Skin that has grown together on animals: found by another pose of the same body, or by a body like it."""

from dataclasses import replace

import numpy as np
import pytest

from addon.core import (
    InvalidMeshError,
    InvalidSettingsError,
    KeptStages,
    Settings,
    canonical_form,
    feature_patches,
    find_contacts,
    mannequin,
)
from addon.core.fused.suspicion import SUSPECT_BESIDE, is_tall, raised
from addon.core.fused.whole_body import WholeBody, known_body, whole_of
from addon.core.run.monitor import Monitor
from tests.meshes import shapes
from tests.meshes.animals import giraffe, walker
from tests.meshes.fused import fused_figure


@pytest.fixture(scope="module")
def kept():
    return KeptStages()


@pytest.fixture(scope="module")
def reference():
    return canonical_form(*walker())


@pytest.fixture(scope="module")
def fused():
    """The fore leg and the hind leg of the right have grown together below the belly."""
    return walker(0.45)


@pytest.fixture(scope="module")
def form(fused, reference, kept):
    return canonical_form(*fused, reference=reference, keep=kept)


def test_legs_of_an_animal_are_parted_by_a_reference(fused, reference, form):
    glued = canonical_form(fused[0], fused[1], Settings(contacts="keep"), reference=reference)
    assert not is_tall(glued.eigenvalues)
    assert raised(glued.eigenvalues, reference.eigenvalues) > SUSPECT_BESIDE
    assert raised(form.eigenvalues, reference.eigenvalues) < 0.07
    assert len(glued.feature_points) < len(form.feature_points) == len(reference.feature_points)
    assert [each.kind for each in form.warnings if each.kind.startswith("contacts")] == ["contacts_opened"]
    where = fused[0][form.contacts]
    assert len(where) > 30
    assert np.abs(where[:, 0]).max() < 0.5  # between the legs,
    assert where[:, 1].max() < -0.2  # of the right,
    assert where[:, 2].max() < -1.2  # below the belly


def test_without_a_reference_nothing_is_known_of_an_animal(fused):
    assert canonical_form(*fused).parted is None


@pytest.mark.parametrize("swing", [0.0, 0.25])
def test_whole_poses_are_not_searched(swing, reference):
    """To the bit: the lowest eigenvalues tell that they are whole."""
    vertices, faces = walker(swing)
    ways = [canonical_form(vertices, faces, Settings(contacts=way), reference=reference) for way in ("keep", "open")]
    np.testing.assert_array_equal(ways[0].vertices, ways[1].vertices)
    assert list(ways[0].timings) == list(ways[1].timings)
    assert ways[0].warnings == ways[1].warnings


@pytest.mark.parametrize("swing", [0.0, 0.3])
def test_a_search_finds_none_on_whole_poses(swing, reference, kept):
    found = find_contacts(*walker(swing), reference=reference, keep=kept)
    assert found.explained
    assert found.residual < 0.006
    assert not found.gone.any()


def test_another_body_explains_nothing(reference, kept):
    found = find_contacts(*shapes.sphere(3), reference=reference, keep=kept)
    assert not found.explained
    assert not found.gone.any()


def test_where_it_stands_decides_nothing(fused, reference, form, kept):
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    found = find_contacts(3.0 * fused[0] @ turn + [5.0, 0, 1], fused[1], reference=reference, keep=kept)
    gone = np.zeros(len(fused[0]), dtype=bool)
    gone[found.faces[found.gone]] = True
    assert (gone & form.contacts).sum() > 0.75 * (gone | form.contacts).sum()


def test_a_cut_that_makes_it_less_like_the_reference_is_not_believed(fused, reference, kept, monkeypatch):
    measured = iter([0.2, 0.25])
    monkeypatch.setattr("addon.core.contacts.raised", lambda *_: next(measured))
    found = canonical_form(*fused, reference=reference, keep=kept)
    assert found.parted is None
    assert any(each.kind == "contacts_left_beside" for each in found.warnings)


def test_a_form_that_was_parted_is_a_reference_as_what_it_was_parted_to(form, reference):
    whole = whole_of(form)
    assert whole is not None
    assert len(whole.vertices) == len(form.parted.mesh.vertices) == len(whole.form)
    np.testing.assert_array_equal(whole.eigenvalues, form.eigenvalues)
    again = canonical_form(*walker(0.42), reference=form)
    assert raised(again.eigenvalues, reference.eigenvalues) < 0.07


def test_a_reference_of_which_only_the_form_is_known(fused, reference):
    bare = replace(reference, posed=np.empty((0, 3)), eigenvalues=np.empty(0))
    found = canonical_form(*fused, reference=bare)
    assert raised(found.eigenvalues, reference.eigenvalues) < 0.07


def test_a_reference_of_several_parts_is_not_used():
    """They touch already."""
    one, two = walker()[0], shapes.sphere(2)
    points = np.concatenate([one, 0.3 * two[0] + [0.0, 0, 0.65]])
    faces = np.concatenate([walker()[1], two[1] + len(one)])
    found = known_body(WholeBody(points, faces, points, np.empty(0)), Settings(), Monitor())
    assert found is None or len(found.form) == len(one)


def test_eigenvalues_of_a_sphere_of_unit_area():
    """4 π l (l + 1)."""
    found = feature_patches(*shapes.sphere(4)).eigenvalues
    np.testing.assert_allclose(found[:8], 4 * np.pi * np.array([2, 2, 2, 6, 6, 6, 6, 6]), rtol=0.02)
    assert raised(found, canonical_form(*shapes.sphere(4)).eigenvalues) == 0


def told(form):
    return [each.kind for each in form.warnings if each.kind.startswith("contacts")]


def test_a_tall_animal_is_whole_beside_itself():
    """A giraffe is as tall for its skin as a human, and unlike one."""
    form = canonical_form(*giraffe())
    assert is_tall(form.eigenvalues)
    again = canonical_form(*giraffe(0.8), reference=form)
    assert told(again) == []
    assert "Limbs" not in again.timings  # nothing was searched for


@pytest.mark.parametrize("other", ["mannequin", "walker"])
def test_a_human_is_suspected_whatever_the_reference(other):
    """Legs and arms have grown together; a thinner human, or an animal, says nothing of that."""
    vertices, faces, _ = fused_figure(86.0, 0.015)
    beside = canonical_form(*{"mannequin": lambda: mannequin(40.0), "walker": walker}[other]())
    form = canonical_form(vertices, faces, reference=beside)
    assert "contacts_opened" in told(form)


def test_a_reference_that_has_grown_together_itself_accuses_no_whole_body(fused):
    glued = canonical_form(fused[0], fused[1], Settings(contacts="keep"))
    whole = canonical_form(*walker(), reference=glued)
    assert told(whole) == []
    assert "Limbs" not in whole.timings


def test_what_the_caller_changes_later_changes_no_reference(fused):
    vertices, faces = walker()
    kept = KeptStages()
    for settings in (Settings(contacts="keep"), Settings()):
        form = canonical_form(vertices, faces, settings, keep=kept)
        assert not np.shares_memory(form.posed, vertices)
        before = form.vertices.copy()
        form.posed[:] *= 2
        form.eigenvalues[:] = 1
        again = canonical_form(vertices, faces, settings, keep=kept)
        np.testing.assert_array_equal(again.vertices, before)
        np.testing.assert_array_equal(again.posed, vertices)
        assert again.eigenvalues[0] > 1


def test_few_eigenpairs_are_enough_for_the_suspicion(fused, reference):
    form = canonical_form(fused[0], fused[1], Settings(eigenpairs=5), reference=reference)
    assert "contacts_opened" in told(form)


def test_chosen_points_are_no_points_of_the_reference(fused):
    small = replace(canonical_form(*walker(cells=40)), eigenvalues=np.empty(0))
    chosen = [len(fused[0]) - 1, 5, 100]
    form = canonical_form(fused[0], fused[1], Settings(feature_points=chosen, quality="draft"), reference=small)
    assert form.feature_points.tolist() == chosen


@pytest.mark.parametrize("field", ["vertices", "posed"])
def test_a_bad_reference_is_named(fused, reference, field):
    points = getattr(reference, field).copy()
    points[reference.faces[0, 0]] = np.nan
    with pytest.raises(InvalidMeshError, match="The reference: "):
        canonical_form(*fused, reference=replace(reference, **{field: points}))


def test_a_reference_without_limbs_is_refused_before_the_search(fused, reference):
    with pytest.raises(InvalidSettingsError, match="no feature points"):
        canonical_form(*fused, reference=replace(reference, bodies=[]), cancelled=lambda: pytest.fail("too late"))
