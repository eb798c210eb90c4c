"""The same mesh, with Blender and without: the same forms, names, lines and messages."""

import io
import json
from pathlib import Path

import numpy as np
import pytest

from addon.batch import opening, plain_file, targets
from addon.batch.command import main
from addon.blender.files.kinds_of_files import PLAIN
from addon.blender.files.plain_files import read_plain, write_plain
from addon.blender.files.polygon_mesh import PolygonMesh
from tests.meshes import shapes

QUICK = ["--max-iterations", "2", "--landmark-count", "12"]
KINDS = [kind[1:] for kind in PLAIN]


@pytest.fixture
def both(tmp_path, monkeypatch):
    """Run the same words with Blender and without, into the folders blender and plain."""

    def run(*words):
        found = []
        for name in ("blender", "plain"):
            monkeypatch.setattr(opening, "has_blender", lambda there=name == "blender": there)
            output = io.StringIO()
            code = main([*map(str, words), "--output", str(tmp_path / name), *QUICK], output, alone=True)
            lines = output.getvalue().replace(str(tmp_path / name), "OUTPUT").splitlines()
            found.append((code, [json.loads(line) for line in lines]))
        return found

    return run


@pytest.fixture
def meshes(tmp_path):
    """The same figure in every kind that both read."""
    vertices, faces = shapes.figure(13)
    (tmp_path / "in").mkdir()
    for kind in KINDS:
        write_plain(tmp_path / "in" / f"{kind}.{kind}", PolygonMesh(vertices, faces.tolist()))
    return tmp_path / "in"


def require_same(line, plain):
    """Require lines to be equal but for seconds, and for numbers after the first digits."""
    assert line.keys() == plain.keys()
    assert line.pop("timings").keys() == plain.pop("timings").keys()
    assert line.pop("measures", {}) == pytest.approx(plain.pop("measures", {}), rel=1e-2)
    for each in (line, plain):  # Blender stores floats of 32 bits
        each.pop("sides", None)
        each.get("like", {}).pop("sides", None)
    assert line == plain


@pytest.mark.parametrize("kind", KINDS)
def test_forms_and_lines_are_the_same(kind, both, meshes, tmp_path):
    (code, [line]), (plain_code, [plain]) = both(
        "compute", meshes / f"{kind}.{kind}", "--format", kind, "--colours", "patches"
    )
    assert code == plain_code == 0
    require_same(line, plain)
    name = Path(line["output"]).name
    one, two = (read_plain(tmp_path / folder / name) for folder in ("blender", "plain"))
    assert one.polygons == two.polygons
    np.testing.assert_allclose(one.vertices, two.vertices, atol=1e-3 * float(np.ptp(two.vertices)))
    marks = [
        [text for text in (tmp_path / folder / name).read_text().splitlines() if text.startswith(("g", "property"))]
        for folder in ("blender", "plain")
    ]
    assert marks[0] == marks[1]
    assert (len(marks[0]) > 3) == (kind != "off")  # patches as groups or colours


@pytest.mark.parametrize("asked", [[], ["--measure", "hausdorff"]])
def test_costly_measures_are_taken_on_request_alone(asked, both, meshes):
    for code, [line] in both("compute", meshes / "off.off", "--format", "off", *asked):
        assert code == 0
        assert ("Hausdorff distance" in line["timings"]) == bool(asked)
        assert line["measures"].get("hausdorff", 1.0) > 0.1
        assert ("hausdorff" in line["measures"]) == bool(asked)


def test_poses_and_matches_are_the_same(both, meshes):
    for words in (("pose-like", meshes / "off.off", "--format", "ply", "--reference"), ("match", meshes / "off.off")):
        (code, [line]), (plain_code, [plain]) = both(*words, meshes / "ply.ply")
        assert code == plain_code == 0
        require_same(line, plain)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["nowhere.off"], "not a file"),
        (["damaged.off"], "cut short"),
        (["off.off", "--objects", "Other"], "off.off holds no mesh object named 'Other'."),
        (["off.off", "--feature-points", "99999"], "between 0 and 557"),
    ],
)
def test_failures_are_told_in_the_same_words(words, sentence, both, meshes, monkeypatch):
    monkeypatch.chdir(meshes)
    Path("damaged.off").write_text("OFF\n3 1 0\n0 0 0\n")
    (code, lines), (plain_code, plain_lines) = both("compute", *words, "--format", "off")
    assert code == plain_code == 1
    assert lines == plain_lines
    assert sentence in lines[0]["error"]


def test_existing_results_are_skipped_alike(both, meshes):
    words = ("compute", meshes / "off.off", "--format", "ply", "--objects", "off")
    both(*words)
    (code, lines), (plain_code, plain_lines) = both(*words, "--skip-existing")
    assert code == plain_code == 0
    assert lines == plain_lines
    assert lines[0]["skipped"]


@pytest.mark.parametrize("fits", [True, False])
def test_long_names_are_used_or_refused_before_anything_is_computed(fits, tmp_path, monkeypatch):
    vertices, faces = shapes.figure(13)
    path = tmp_path / f"{'x' * 251}.off"
    write_plain(path, PolygonMesh(vertices, faces.tolist()))
    monkeypatch.setattr(opening, "has_blender", lambda: False)
    if not fits:
        monkeypatch.setattr(targets, "LONGEST", 250)
        monkeypatch.setattr(plain_file, "canonical_form", None)
    output = io.StringIO()
    words = ["compute", str(path), "--output", str(tmp_path / "out"), "--format", "off", *QUICK]
    assert main(words, output, alone=True) == (0 if fits else 1)
    line = json.loads(output.getvalue())
    assert Path(line["output"]).is_file() if fits else "name of the result has 255 bytes" in line["error"]
