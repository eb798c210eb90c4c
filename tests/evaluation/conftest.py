import numpy as np
import pytest

from tests.meshes import shapes
from tests.meshes.shapes import write_off


@pytest.fixture(scope="session")
def dataset(tmp_path_factory):
    """Three classes of three small shapes: figures, ellipsoids and dumb-bells, each in poses of one vertex order."""
    folder = tmp_path_factory.mktemp("dataset")
    rng = np.random.default_rng(0)
    figure, faces = shapes.figure(9)
    ball, ball_faces = shapes.sphere(2)
    for number in range(3):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        bend = 0.25 * number * np.sin(figure[:, 2:])
        write_off(folder / "figure" / f"figure{number}.off", (figure + bend * [1.0, 0.5, 0.0]) @ turn, faces)
        egg = ball * [1.0, 1.4 + 0.1 * number, 2.2]
        write_off(folder / "egg" / f"egg{number}.off", egg @ turn + 3.0, ball_faces)
        waist = 0.35 + np.abs(ball[:, 2:]) ** 2
        bell = ball * np.concatenate([waist, waist, np.full_like(waist, 2.0 + 0.1 * number)], axis=1)
        write_off(folder / "bell" / f"bell{number}.off", 5.0 * bell @ turn, ball_faces)
    return folder


@pytest.fixture
def tables_of():
    """A reader of every table of a run that must not differ between runs: all but the costs."""

    def read(folder):
        names = sorted([*folder.glob("*.csv"), folder / "report.md"])
        return {path.name: path.read_bytes() for path in names if path.name != "costs.csv"}

    return read
