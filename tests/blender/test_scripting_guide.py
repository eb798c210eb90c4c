"""The examples of the scripting guide, run as they stand."""

import re
from pathlib import Path

import bpy

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "scripting.md"


def test_the_examples_run(figure_object, arrays, capsys):
    inside, outside = GUIDE.read_text().split("## On arrays")
    scope: dict[str, object] = {}
    for example in re.findall(r"```python\n(.*?)```", inside, flags=re.DOTALL):
        exec(compile(example, "scripting.md", "exec"), scope)
    assert "Figure Canonical Form" in bpy.data.objects
    vertices, faces = arrays
    (example,) = re.findall(r"```python\n(.*?)```", outside, flags=re.DOTALL)[:1]
    exec(compile(example, "scripting.md", "exec"), {"vertices": vertices, "faces": faces})
    assert capsys.readouterr().out
