"""Bodies that the tests of matching share."""

import pytest

from addon.core.matching.unfolded import unfolded
from addon.core.method_api.settings import Settings
from addon.core.method_api.surface_features import detected
from addon.core.run.monitor import Monitor
from tests.meshes import shapes


@pytest.fixture(scope="session")
def gathered():
    """A function: what matching needs to know of a mesh whose form is the mesh itself."""

    def gather(vertices, faces):
        found = detected(shapes.unit(vertices, faces), faces, None, Settings(), Monitor())
        return unfolded(found, found.whole_points, Monitor())

    return gather


@pytest.fixture(scope="session")
def body(gathered):
    """The bent figure of five limbs, 778 vertices."""
    return gathered(*shapes.figure(15))


@pytest.fixture(scope="session")
def renumbered(gathered):
    """The same body with its vertices in another order, and the old number of each new vertex."""
    vertices, faces, old = shapes.permuted(*shapes.figure(15))
    return gathered(vertices, faces), old
