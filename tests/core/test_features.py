import numpy as np
import pytest

from addon.core import CancelledError, Settings, canonical_form, feature_patches


def test_features_and_patches_alone_are_those_of_the_form(figure):
    vertices, faces = figure
    seen = []
    found = feature_patches(vertices, faces, progress=lambda done, stage: seen.append((done, stage)))
    form = canonical_form(vertices, faces)
    np.testing.assert_array_equal(found.feature_points, form.feature_points)
    np.testing.assert_array_equal(found.patches, form.patches)
    np.testing.assert_allclose(found.adf, form.adf)
    assert seen[-1] == (1.0, "Patches")
    assert list(found.timings)[-1] == "Patches"


def test_the_number_of_feature_points_can_be_asked_for(figure):
    vertices, faces = figure
    five = feature_patches(vertices, faces)
    three = feature_patches(vertices, faces, Settings(feature_count=3))
    highest = five.feature_points[np.argsort(-five.adf[five.feature_points])[:3]]
    assert set(three.feature_points) == set(highest)
    assert len(feature_patches(vertices, faces, Settings(feature_count=7)).feature_points) == 7
    many = feature_patches(vertices, faces, Settings(feature_count=400))
    assert "fewer than requested" in many.warnings[-1]


def test_it_can_be_cancelled(figure):
    with pytest.raises(CancelledError):
        feature_patches(*figure, cancelled=lambda: True)
