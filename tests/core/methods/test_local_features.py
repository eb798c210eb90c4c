"""The paper's form with its limbs straight: what its last step, the detail pass, gives way to."""

import pytest

from addon.core import canonical_form
from addon.core.measures.form_measures import worst_part_distortion
from addon.core.methods import local_features
from tests.meshes import shapes


@pytest.mark.parametrize(("degrees", "radius", "gives_way"), [(110, 0.15, True), (175, 0.2, False)])
def test_a_weaker_pull_is_taken_where_it_spares_the_edges(degrees, radius, gives_way, monkeypatch):
    vertices, faces = shapes.joint(degrees, radius=radius)
    sparing = worst_part_distortion(vertices, canonical_form(vertices, faces).vertices, faces)
    monkeypatch.setattr(local_features, "_MOST_DISTORTED", 1.0)
    firm = worst_part_distortion(vertices, canonical_form(vertices, faces).vertices, faces)
    assert firm > 0.24
    assert sparing < firm - 0.015 if gives_way else sparing == firm
