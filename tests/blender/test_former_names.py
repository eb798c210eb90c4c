"""Options under the names that they had in version 0.1, in operators and on the command line."""

import io
import json

import bpy
import pytest

from addon.batch.command import main
from addon.blender.records.record import require_record
from tests.meshes import shapes

from .conftest import QUICK


def test_an_operator_takes_former_names(figure_object):
    with pytest.warns(FutureWarning, match="use max_iterations"):
        bpy.ops.object.canonical_form(eigenpairs=QUICK["eigenpairs"], iterations=2, landmarks=12)
    stress = require_record(figure_object.data).report.stress
    assert stress is not None
    assert stress.steps == 2


def test_as_published_is_a_method_now(figure_object):
    with pytest.warns(FutureWarning, match='method="as_published"'):
        bpy.ops.object.canonical_form(max_iterations=1, as_published=True)
    assert require_record(figure_object.data).report.method == "as_published"


def test_the_command_line_takes_former_flags(tmp_path, capsys):
    shapes.write_off(tmp_path / "figure.off", *shapes.figure(13))
    lines = io.StringIO()
    words = ["compute", str(tmp_path / "figure.off"), "--output", str(tmp_path / "out")]
    assert main([*words, "--eigenpairs", "20", "--iterations", "2", "--landmarks", "12"], lines, alone=True) == 0
    told = capsys.readouterr().err.splitlines()
    assert [line.partition(";")[2] for line in told] == [" use landmark_count.", " use max_iterations."]
    assert all(line.startswith("canonical_form: The setting ") for line in told)
    assert json.loads(lines.getvalue())["stress"]["steps"] == 2
    lines = io.StringIO()
    assert main([*words, "--max-iterations", "1", "--as-published"], lines, alone=True) == 0
    assert 'use method="as_published".' in capsys.readouterr().err
    assert json.loads(lines.getvalue())["method"] == "as_published"


def test_the_options_hide_nothing_of_a_property_group(figure_object):
    chosen = bpy.context.scene.canonical_form
    for name in ("items", "keys", "values", "get", "pop"):
        assert getattr(type(chosen), name) == getattr(bpy.types.PropertyGroup, name), name
