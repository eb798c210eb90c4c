"""Parts chosen by their shares."""

import numpy as np

from addon.core.numerics.shares import spread


def test_samples_are_spread_by_area():
    share = np.array([0.5, 0.125, 0.125, 0.25])
    np.testing.assert_array_equal(np.bincount(spread(share, 8)), [4, 1, 1, 2])
