"""The scripts of the scripting guide and of the page of examples, run as they stand."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "scripting.md"


def test_the_examples_run(figure_object, arrays, capsys):
    inside, outside = GUIDE.read_text().split("## On arrays")
    scope: dict[str, object] = {}
    for example in re.findall(r"```python\n(.*?)```", inside, flags=re.DOTALL):
        exec(compile(example, "scripting.md", "exec"), scope)
    assert "Figure Canonical Form" in bpy.data.objects
    vertices, faces = arrays
    scope = {"vertices": vertices, "faces": faces, "other_vertices": vertices, "other_faces": faces,
             "other_weights": vertices}  # fmt: skip
    for example in re.findall(r"```python\n(.*?)```", outside.split("## The command line")[0], flags=re.DOTALL):
        exec(compile(example, "scripting.md", "exec"), scope)
        assert capsys.readouterr().out


def test_the_page_of_examples_runs(figure_object, arrays):
    vertices, faces = arrays
    scope: dict[str, object] = {"bpy": bpy, "poses": [vertices, vertices[:, [1, 2, 0]]], "faces": faces}
    base = bpy.data.objects.new("Base", figure_object.data.copy())
    bpy.context.collection.objects.link(base)
    base.vertex_groups.new(name="Bone").add([0], 1.0, "REPLACE")
    figure_object.data.vertices.foreach_set("select", [True] + [False] * (len(vertices) - 1))
    page = GUIDE.with_name("examples.md").read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert len(examples) == page.count("```python")
    for example in examples:
        example = example.replace('pose="T"', 'pose="T", anyway=True')  # a quick figure is hardly human
        exec(compile(example, "examples.md", "exec"), scope)
    assert "Bone" in figure_object.vertex_groups
    assert len(scope["alike"]) == 2  # type: ignore[arg-type]


def test_the_pipeline_runs(tmp_path, arrays, capsys, monkeypatch):
    page = GUIDE.read_text().split("## From a folder of scans")[1]
    scans = tmp_path / "scans"
    scans.mkdir()
    vertices, faces = shapes.figure(14)
    for name, turned in (("one", vertices), ("two", vertices[:, [1, 2, 0]] + 5)):
        shapes.write_off(scans / f"{name}.off", turned, faces)
    (scans / "broken.off").write_text("OFF")
    (command,) = re.findall(r"```sh\n(.*?)```", page, flags=re.DOTALL)
    command = command.replace("--reference first", f"--reference {scans / 'one.off'}")  # the first by name is broken
    root = GUIDE.parents[1]
    done = subprocess.run(["bash", "-c", command.replace("python", sys.executable, 1)], cwd=tmp_path, check=False,
                          env={**os.environ, "PYTHONPATH": str(root)}, capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 1
    lines = [json.loads(line) for line in (tmp_path / "report.jsonl").read_text().splitlines()]
    assert {Path(line["input"]).stem: "error" in line for line in lines} == {"one": False, "two": False, "broken": True}
    forms = [shapes.read_obj(tmp_path / "normalised" / f"{name}.obj")[0] for name in ("one", "two")]
    assert abs(forms[0] - forms[1]).max() < 1e-3 * abs(forms[0]).max()
    monkeypatch.chdir(tmp_path)
    scope = {"vertices": arrays[0], "faces": arrays[1], "other_vertices": arrays[0], "other_faces": arrays[1]}
    for example in re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL):
        exec(compile(example, "scripting.md", "exec"), scope)
    told = capsys.readouterr().out
    assert "2 of 3 normalised" in told
    assert "broken.off" in told
