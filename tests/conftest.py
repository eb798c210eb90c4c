"""Shapes that the tests share."""

import os
from pathlib import Path

if "PYTEST_XDIST_WORKER" in os.environ:  # as many processes as cores: more threads only wait for each other
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pytest

from tests.meshes import shapes

DATA = Path(os.environ.get("CANONICAL_FORM_DATA", Path(__file__).resolve().parents[2] / "shared" / "data"))


@pytest.fixture(autouse=True)
def whole_bodies(request, monkeypatch):
    """Let small figures, whose four ends are suspect, take no search for contacts but where that is what is tested."""
    if request.path.parent.name != "fused" and request.path.name not in ("test_contacts.py", "test_parted_objects.py"):
        for limit in ("SUSPECT", "SUSPECT_BESIDE"):
            monkeypatch.setattr(f"addon.core.contacts.{limit}", np.inf)


@pytest.fixture(scope="session")
def sphere():
    """A sphere of radius 1 with 2,562 vertices."""
    return shapes.sphere(4)


@pytest.fixture(scope="session")
def figure():
    """A small bent figure with five limbs and about 2,000 vertices, closed and not symmetric."""
    return shapes.figure()


@pytest.fixture(scope="session")
def real_mesh():
    """A loader of real posed meshes; the test is skipped where they are not at hand."""

    def load(name: str):
        path = DATA / name
        if not path.is_file():
            pytest.skip(f"needs the real mesh {name} (set CANONICAL_FORM_DATA)")
        return shapes.read_obj(path)

    return load


@pytest.fixture
def rotation():
    """A rotation about no axis in particular."""
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    return turn * np.sign(np.linalg.det(turn))
