"""One test a row of docs/any-mesh.md: what is promised for every family of meshes."""

from typing import Any

import numpy as np
import pytest

from addon.core import (
    CanonicalFormError,
    InvalidMeshError,
    InvalidSettingsError,
    Settings,
    TooLargeError,
    canonical_form,
    feature_patches,
)
from addon.core.distance_fields import KINDS, distance_field, heat_geodesics
from addon.core.limbs import limb_shapes
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.geometry import surface_area
from tests.meshes import shapes
from tests.meshes.families import families

FAMILIES = families()


@pytest.fixture(scope="module")
def forms():
    """Forms by name, each made once."""
    made = {}

    def form_of(name):
        if name not in made:
            made[name] = canonical_form(FAMILIES[name].vertices, FAMILIES[name].faces)
        return made[name]

    return form_of


SIMPLE = (
    "no_pairs",
    "one_pair",
    "no_head",
    "unpaired_ends",
    "twisted",
    "hardly_unbent",
    "handles",
)  # true of balls, planes, handles


@pytest.mark.parametrize("name", [name for name, family in FAMILIES.items() if not family.refused])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_it_has_a_form(name, forms):
    family, form = FAMILIES[name], forms(name)
    vertices = family.vertices
    assert form.vertices.shape == vertices.shape
    assert np.isfinite(form.vertices).all()
    assert family.warns in " ".join(form.warnings)
    if not family.warns:
        assert [told.kind for told in form.warnings if told.kind not in SIMPLE] == []
    count = len(form.feature_points)
    assert count
    assert set(np.unique(form.patches)) - {-1} == set(range(count))
    np.testing.assert_array_equal(form.patches[form.feature_points], np.arange(count))
    on_surface = np.isin(np.arange(len(vertices)), form.faces)
    assert (form.adf[on_surface] > 0).all()
    area = [surface_area(each / family.scale, form.faces) for each in (vertices, form.vertices)]
    assert area[1] == pytest.approx(area[0], rel=1e-6)
    with np.errstate(divide="ignore", invalid="ignore"):
        stretch = edge_stretch(vertices, form.vertices, form.faces)
    assert np.nanmedian(np.abs(stretch - 1)) < 0.12


@pytest.mark.parametrize("name", [name for name, family in FAMILIES.items() if family.like])
def test_it_has_the_form_of_the_mesh_without_the_flaw(name, forms):
    family = FAMILIES[name]
    here, there = np.flatnonzero(family.same >= 0), family.same[family.same >= 0]
    found = forms(name).vertices[here] / family.scale
    wanted = forms(family.like).vertices[there]
    size = np.ptp(wanted, axis=0).max()
    moved = found - found[0], wanted - wanted[0]  # where it is, is another matter
    assert np.linalg.norm(moved[0] - moved[1], axis=1).max() < family.within * size


@pytest.mark.parametrize("name", [name for name, family in FAMILIES.items() if family.refused])
@pytest.mark.parametrize("work", [canonical_form, feature_patches])
def test_it_is_refused_before_anything_is_computed(name, work):
    stages = []
    with pytest.raises(CanonicalFormError, match=FAMILIES[name].refused):
        work(FAMILIES[name].vertices, FAMILIES[name].faces, progress=lambda done, stage: stages.append(stage))
    assert set(stages) <= {"Surface"}


def test_what_belongs_to_no_face_stays(forms):
    family = FAMILIES["isolated vertices"]
    alone = family.same < 0
    form = forms("isolated vertices")
    np.testing.assert_array_equal(form.vertices[alone], family.vertices[alone])
    assert (form.patches[alone] == -1).all()
    assert (form.patches[~alone] >= 0).all()


def test_each_part_has_the_form_that_it_has_alone(forms):
    family, form = FAMILIES["loose parts"], forms("loose parts")
    ball = np.arange(2108, 2108 + 642)
    faces = family.faces[np.isin(family.faces, ball).all(axis=1)]
    alone = canonical_form(family.vertices[ball], faces - ball[0])
    np.testing.assert_allclose(form.vertices[ball], alone.vertices, atol=1e-12)
    assert not set(form.patches[ball]) & set(form.patches[:2108])
    np.testing.assert_array_equal(np.unique(form.patches[:2108]), np.arange(5))  # of the largest part come first


def test_given_features_keep_their_order_over_the_parts():
    family = FAMILIES["loose parts"]
    found = feature_patches(family.vertices, family.faces)
    given = [3000, 5, 900]  # none in the ball
    chosen = feature_patches(family.vertices, family.faces, Settings(feature_points=given))
    np.testing.assert_array_equal(chosen.feature_points[:3], given)
    np.testing.assert_array_equal(chosen.patches[given], [0, 1, 2])
    assert len(chosen.feature_points) == 4
    assert "1 loose parts have none" in " ".join(chosen.warnings)
    assert len(found.feature_points) == 8


def test_a_feature_point_on_a_seam_stays_the_one_that_was_given():
    family = FAMILIES["duplicate vertices"]
    copies = np.flatnonzero(np.bincount(family.same)[family.same] > 1)
    given = [int(copies[-1]), int(np.flatnonzero(~np.isin(np.arange(len(family.same)), copies))[0])]
    found = feature_patches(family.vertices, family.faces, Settings(feature_points=given))
    np.testing.assert_array_equal(found.feature_points, given)
    np.testing.assert_array_equal(found.patches[given], [0, 1])
    twin = next(int(each) for each in copies if family.same[each] == family.same[given[0]] and each != given[0])
    assert found.patches[twin] == 0
    with pytest.raises(InvalidSettingsError, match="two vertices at one position"):
        feature_patches(family.vertices, family.faces, Settings(feature_points=[given[0], twin]))


def test_too_large_a_part_is_refused_before_the_first_is_computed():
    vertices, faces = shapes.grid(30, 30, 100.0, 100.0)
    fine, its = shapes.grid(150, 150)
    stages = []
    with pytest.raises(TooLargeError):
        canonical_form(
            np.vstack([vertices, fine + 200]), np.vstack([faces, its + len(vertices)]), Settings(memory_limit=0.06),
            progress=lambda done, stage: stages.append(stage),
        )  # fmt: skip
    assert set(stages) == {"Surface"}


@pytest.mark.parametrize("sources", [[-1], [99], [1.9], ["a"], []])
@pytest.mark.parametrize("measure", [heat_geodesics, distance_field])
def test_what_is_no_vertex_is_refused(measure, sources):
    with pytest.raises(InvalidSettingsError, match="Source vertices"):
        measure(*shapes.grid(5, 5), sources)


@pytest.mark.parametrize("kind", KINDS)
def test_distances_end_where_the_part_ends(kind):
    family = FAMILIES["loose parts"]
    field = distance_field(family.vertices, family.faces, [3, 7], kind)
    assert np.isfinite(field[:2108]).all()
    assert (field[[3, 7]] == 0).all()
    assert np.isinf(field[2108:]).all()


@pytest.mark.parametrize("name", ["loose parts", "isolated vertices", "duplicate vertices", "one-sided, closed"])
def test_limbs_of_any_mesh(name, forms):
    family, form = FAMILIES[name], forms(name)
    chosen = form.patches == 0
    (shape,) = limb_shapes(family.vertices, family.faces, form.vertices, chosen)
    assert np.isfinite(shape).all()
    whole = limb_shapes(family.vertices, family.faces, form.vertices, form.patches >= 0, ways=[0.5, 1.0])
    np.testing.assert_allclose(whole[1], form.vertices, atol=1e-9)
    assert np.isfinite(whole[0]).all()


@pytest.mark.parametrize(
    ("wrong", "error"),
    [({"form": np.zeros((3, 3))}, InvalidMeshError), ({"form": np.full((36, 3), np.nan)}, InvalidMeshError),
     ({"chosen": [True]}, InvalidSettingsError), ({"chosen": np.zeros(36)}, InvalidSettingsError),
     ({"ways": [np.nan]}, InvalidSettingsError), ({"ways": [2]}, InvalidSettingsError)],
)  # fmt: skip
def test_limbs_of_what_does_not_fit_are_refused(wrong, error):
    vertices, faces = shapes.grid(6, 6)
    fitting: dict[str, Any] = {"form": vertices, "chosen": vertices[:, 0] > 0.5, "ways": [1.0]}
    limb_shapes(vertices, faces, **fitting)
    with pytest.raises(error):
        limb_shapes(vertices, faces, **(fitting | wrong))


@pytest.mark.parametrize("size", [1e-120, 1e120])
def test_limbs_of_any_size(size):
    vertices, faces = shapes.grid(9, 3, 4.0, 1.0)
    bent = np.column_stack([vertices[:, 0], vertices[:, 1], 0.2 * vertices[:, 0] ** 2])
    chosen = vertices[:, 0] > 3
    (small,) = limb_shapes(bent, faces, vertices, chosen)
    (sized,) = limb_shapes(size * bent, faces, size * vertices, chosen)
    np.testing.assert_allclose(sized / size, small, atol=1e-9)
