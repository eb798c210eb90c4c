"""The paper's form with its limbs straight: what its last step, the detail pass, gives way to."""

import pytest

from addon.core import canonical_form
from addon.core.measures.form_measures import worst_part_distortion
from addon.core.methods import local_features
from tests.meshes import shapes
from tests.meshes.pieced import character


@pytest.mark.parametrize("gives_way", [True, False])
def test_a_weaker_pull_is_taken_where_it_spares_the_edges(gives_way, monkeypatch):
    """A character in pieces has one that the straight form stretches; a sharp fold is distorted in any case."""
    pieces = character()[2]
    vertices, faces = (pieces.vertices, pieces.faces) if gives_way else shapes.joint(175, radius=0.2)
    sparing = worst_part_distortion(vertices, canonical_form(vertices, faces).vertices, faces)
    monkeypatch.setattr(local_features, "_MOST_DISTORTED", 1.0)
    firm = worst_part_distortion(vertices, canonical_form(vertices, faces).vertices, faces)
    assert firm > 0.18
    assert sparing < firm - 0.008 if gives_way else sparing == firm
