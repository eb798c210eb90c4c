"""The contract of what takes two meshes, on meshes that nobody would draw: `tests/core/test_contract.py` draws them.

``CANONICAL_FORM_EXAMPLES=20000`` makes the run long here, too.
"""

from contextlib import suppress

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from addon.core import CanonicalFormError, canonical_form, limb_shapes, match, pose_like, transferred
from tests.core.test_contract import QUICK, examples, form_or_reason, meshes, meshes_of_pieces


@examples(0.06)
@given(st.one_of(meshes(), meshes_of_pieces()), meshes())
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_any_form_lies_on_any_reference_or_says_why_not(mesh, other):
    reference = form_or_reason(other)
    if reference is None:
        return
    with suppress(CanonicalFormError):
        vertices, faces = mesh
        form = canonical_form(vertices, faces, QUICK, reference=reference)
        assert form.vertices.shape == vertices.shape
        assert np.isfinite(form.vertices).all()
        assert len(set(form.feature_points.tolist())) == len(form.feature_points)


@examples(0.06)
@given(meshes(), meshes())
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_any_two_meshes_have_a_match_and_a_pose_or_a_reason(mesh, other):
    (vertices, faces), (others, other_faces) = mesh, other
    with suppress(CanonicalFormError):
        found = match(vertices, faces, others, other_faces, QUICK)
        assert np.isfinite(found.weights).all()
        assert found.faces.max(initial=-1) < len(found.other_faces)
        carried = transferred(found, others)
        assert np.isfinite(carried).all()
    with suppress(CanonicalFormError):
        posed = pose_like(vertices, faces, others, other_faces, QUICK)
        assert posed.vertices.shape == vertices.shape
        assert np.isfinite(posed.vertices).all()


@examples(0.06)
@given(meshes(), st.integers(0, 2**32 - 1))
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_any_limb_is_straightened_alone_or_says_why_not(mesh, seed):
    vertices, faces = mesh
    form = form_or_reason(mesh)
    if form is None:
        return
    chosen = form.patches == np.random.default_rng(seed).integers(0, len(form.feature_points))
    with suppress(CanonicalFormError):
        shapes = limb_shapes(vertices, faces, form.vertices, chosen, ways=(0.5, 1.0))
        assert np.isfinite(shapes).all()
