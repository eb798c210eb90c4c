"""The Python package: built, installed without Blender, typed, and its notebooks run."""

import json
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

import addon

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
USER = '''
"""What a user writes."""

import numpy as np

from canonical_form import CanonicalForm, InvalidMeshError, Settings, canonical_form, load, mannequin, match, save
from canonical_form.core import transferred

vertices, faces = mannequin(arms=30.0)
form: CanonicalForm = canonical_form(vertices, faces, Settings(quality="draft"), orientation="upright")
heights = np.abs(form.vertices[:, 2])
found = match(vertices, faces, vertices, faces, {"quality": "draft"})
values = transferred(found, heights).round(3)
path = save("form", form)
try:
    again = load(path)
except InvalidMeshError as error:
    print(error.kind, error.numbers)
'''


def run(*command, **options):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The wheel and the source archive."""
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "hatchling", "build", "-d", folder, cwd=ROOT)
    return next(folder.glob("*.whl")), next(folder.glob("*.tar.gz"))


@pytest.fixture(scope="module")
def installed(built, tmp_path_factory):
    """A folder with the wheel installed, and nothing else."""
    folder = tmp_path_factory.mktemp("site")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"]
    run(*pip, "--target", folder, built[0])
    return folder


def without_blender(folder, code, tmp_path):
    """Run code where only the installed package, numpy and the like can be imported."""
    program = f"import sys; sys.modules['bpy'] = None\n{code}"
    return run(
        sys.executable, "-c", program, cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(folder), "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip


def test_the_wheel_has_the_code_its_types_and_what_an_index_asks_for(built):
    names = zipfile.ZipFile(built[0]).namelist()
    assert {"canonical_form/__init__.py", "canonical_form/py.typed", "canonical_form/core/canonical.py"} <= {*names}
    assert not [name for name in names if name.startswith(("tests", "addon", "tools"))]
    described = zipfile.ZipFile(built[0]).read(next(name for name in names if name.endswith("METADATA"))).decode()
    for line in ("License-Expression: GPL-3.0-or-later", "Requires-Python: >=3.11", "Requires-Dist: scipy"):
        assert line in described
    assert "Description-Content-Type: text/markdown" in described


def test_the_source_archive_builds_the_same_wheel(built, tmp_path):
    with tarfile.open(built[1]) as archive:
        archive.extractall(tmp_path, filter="data")
    (source,) = tmp_path.iterdir()
    run(sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", tmp_path / "again", cwd=source)
    (again,) = (tmp_path / "again").glob("*.whl")
    assert {*zipfile.ZipFile(again).namelist()} == {*zipfile.ZipFile(built[0]).namelist()}


def test_there_is_one_version(installed, tmp_path):
    said = without_blender(installed, "import canonical_form; print(canonical_form.__version__)", tmp_path)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert said.strip() == addon.__version__ == project["version"] == manifest["version"]


def test_importing_it_needs_neither_blender_nor_scipy(installed, tmp_path):
    code = "import canonical_form; canonical_form.Settings(); print(sorted({'scipy', 'matplotlib'} & {*sys.modules}))"
    assert without_blender(installed, code, tmp_path).strip() == "[]"


def test_what_a_user_writes_passes_the_strictest_check(installed, tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "user.py").write_text(USER, encoding="utf-8")
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--follow-imports=silent", "user.py"],
        cwd=tmp_path, env={**os.environ, "MYPYPATH": str(installed)}, capture_output=True, text=True,
    )  # fmt: skip
    assert found.returncode == 0, found.stdout


def test_types_are_really_seen(installed, tmp_path):
    (tmp_path / "user.py").write_text(USER + "\ncanonical_form(vertices, faces, 3)\nform.nothing\n", encoding="utf-8")
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--follow-imports=silent", "user.py"],
        cwd=tmp_path, env={**os.environ, "MYPYPATH": str(installed)}, capture_output=True, text=True,
    )  # fmt: skip
    assert found.stdout.count("error:") == 2, found.stdout


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_from_top_to_bottom(installed, tmp_path, notebook):
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    assert not any(cell.get("outputs") for cell in cells)  # they are made by who runs it
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    checks = {
        "form-and-retrieval": "assert right['canonical forms'] == 1.0 > right['as posed'], right",
        "match-and-transfer": "assert np.median(missed) < 0.01 and agree > 0.98, (np.median(missed), agree)",
    }
    without_blender(installed, f"{code}\n{checks[notebook.stem]}", tmp_path)


def test_the_page_for_python_runs_as_it_stands(installed, tmp_path):
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert len(examples) == page.count("```python") > 3
    assert "(30346, 3)" in without_blender(installed, "\n".join(examples), tmp_path)


def test_plot_says_what_is_wrong(installed):
    from addon.evaluation.plotting import plot

    tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    pytest.importorskip("matplotlib").use("Agg")
    with pytest.raises(ValueError, match="faces"):
        plot(tetrahedron)
    with pytest.raises(ValueError, match="one value for each of the 4 vertices"):
        plot(tetrahedron, faces, values=[1.0])
    axes = plot(tetrahedron, faces, patches=[0, 0, 1, -1], title="A tetrahedron")
    assert axes.get_title() == "A tetrahedron"
    assert plot(addon.canonical_form(tetrahedron, faces), axes=axes) is axes
