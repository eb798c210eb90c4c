"""What each object of a body gets of a match of the whole."""

import numpy as np

from addon.blender.transfer.transfer_task import _part
from addon.core import Match, transferred
from addon.core.matching.seam_sides import SeamSides
from addon.core.results import MatchedSeams


def test_copies_keep_their_sides_in_the_object_that_has_them():
    faces = np.array([[0, 1, 2], [3, 5, 4]])  # two triangles of a source that is cut between 1, 2 and 4, 5
    on, weights = np.zeros(7, dtype=int), np.tile([0.0, 1.0, 0.0], (7, 1))
    sides = SeamSides(np.array([4, 6]), np.array([0, 1]), np.array([[0.0, 1, 0], [0.0, 0, 1]]))
    seams = MatchedSeams(np.array([0, 1, 2, 3, 4, 5, 4]), np.array([0, 1, 2, 3, 1, 2]), sides)
    found = Match(faces[on, 1], on, weights, np.ones(7), [], faces, 6, {}, [], [], seams)
    values = np.array([0.0, 1, 1, 0, 5, 5])
    whole = transferred(found, values)
    np.testing.assert_array_equal(whole, [1, 1, 1, 1, 1, 1, 5])
    for start, end in ((0, 3), (3, 7)):
        np.testing.assert_array_equal(transferred(_part(found, start, end), values), whole[start:end])
