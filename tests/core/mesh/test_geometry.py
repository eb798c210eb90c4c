"""What is measured on a mesh in space."""

import numpy as np
import pytest

from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import signed_volume
from tests.meshes import shapes


def test_volume_and_closedness():
    vertices, faces = shapes.sphere(4)
    assert signed_volume(vertices, faces) == pytest.approx(4 / 3 * np.pi, rel=0.01)
    assert signed_volume(vertices, faces[:, ::-1]) == pytest.approx(-4 / 3 * np.pi, rel=0.01)
    assert is_closed(faces)
    assert not is_closed(faces[1:])
    assert not is_closed(np.concatenate([faces, faces]))
