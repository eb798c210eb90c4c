"""How far each vertex goes with its limb."""

from addon.core import Settings, canonical_form
from addon.core.posing.limb_amounts import limb_amounts


def test_a_small_limb_has_a_band_of_its_own(figure):
    points, faces = figure
    found = canonical_form(points, faces, Settings(prominence=0.03))
    for patch in range(len(found.feature_points)):
        amounts = limb_amounts(points, faces, found.patches != patch)
        assert amounts[found.patches == patch].min() == 0
        assert amounts[found.patches != patch].max() == 1
