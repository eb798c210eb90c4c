"""The docs say what the code does."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from addon.core import Settings
from tests.meshes import shapes

ROOT = Path(__file__).resolve().parents[1]


def test_the_api_page_is_up_to_date():
    done = subprocess.run(
        [sys.executable, "tools/api_reference.py", "--check"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("page", ["README.md", *(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/*.md"))])
def test_links_lead_somewhere(page):
    text = (ROOT / page).read_text()
    for link in re.findall(r"\]\(([^)#]+)[^)]*\)", text):
        if not link.startswith("http"):
            assert ((ROOT / page).parent / link).stat().st_size > 0, link


def test_the_readmes_script_runs(capsys):
    script = re.findall(r"```python\n(from addon\.core.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)[0]
    vertices, faces = shapes.figure(11)
    exec(compile(script, "README.md", "exec"), {"vertices": vertices, "faces": faces})
    assert "100% Alignment" in capsys.readouterr().out


def test_versions_agree():
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert manifest["version"] == project["project"]["version"]
    assert f"## {manifest['version']}" in (ROOT / "docs" / "CHANGELOG.md").read_text()
    assert len(manifest["tagline"]) <= 64


def test_the_method_page_states_the_defaults():
    text = (ROOT / "docs" / "method.md").read_text()
    settings = Settings()
    assert f"t = {settings.diffusion_time}" in text
    assert f"prominence ≥ {settings.prominence}" in text
    assert f"smoothing {settings.smoothing}" in text
    assert f"share {settings.arrangement_share:g}" in text


def test_the_core_imports_no_blender_and_files_stay_small():
    for path in (ROOT / "addon").rglob("*.py"):
        text = path.read_text()
        assert "core" not in path.parts or not re.search(r"^\s*(import|from) bpy", text, flags=re.MULTILINE), path
        assert text.count("\n") <= 400, path


def test_every_operator_and_panel_option_is_in_the_guides():
    from addon.interface import properties

    guide = (ROOT / "docs" / "user-guide.md").read_text()
    scripting = (ROOT / "docs" / "scripting.md").read_text()
    for owner in (properties.MethodProperties, properties.RequestProperties):
        for definition in owner.__annotations__.values():
            name = definition.keywords["name"]
            assert name in guide or name == "Vertex Group", name
    source = "".join(path.read_text() for path in (ROOT / "addon" / "interface").glob("*.py"))
    for name in re.findall(r'bl_idname = "object\.(\w+)"', source):
        if name not in ("canonical_form_cancel", "canonical_form_choose"):
            assert f"bpy.ops.object.{name}(" in scripting, name
