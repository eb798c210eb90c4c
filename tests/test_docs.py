"""The docs say what the code does."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from addon.core import Settings

ROOT = Path(__file__).resolve().parents[1]


def test_the_api_pages_are_up_to_date():
    done = subprocess.run(
        [sys.executable, "tools/api_reference.py", "--check"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("page", ["README.md", *(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/**/*.md"))])
def test_links_lead_somewhere(page):
    text = (ROOT / page).read_text()
    for link in re.findall(r"\]\(([^)#]+)[^)]*\)", text):
        if not link.startswith("http"):
            assert ((ROOT / page).parent / link).stat().st_size > 0, link


def test_the_readmes_script_runs(capsys):
    script = re.findall(r"```python\n(from addon\.core.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)[0]
    exec(compile(script, "README.md", "exec"), {})
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


def test_times_and_ratios_told_elsewhere_agree_with_the_benchmarks():
    text = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    scale = text.split("## Scale")[1].split("## ")[0]
    seconds = {
        int(n.replace(",", "")): float(s) for n, s in re.findall(r"^\| ([\d,]+) \| ([\d.]+) s", scale, re.MULTILINE)
    }
    assert seconds[10_000] < 1.5  # about a second
    assert seconds[160_000] < 5
    assert seconds[1_000_000] < 30
    for page in ("README.md", "docs/user-guide.md"):
        told = " ".join((ROOT / page).read_text(encoding="utf-8").split())
        assert re.search(r"under five (seconds )?for 160,000", told), page
        assert "under half a minute for a million" in told, page
    table = text.split("## Quality")[1].split("\n\n")[1].splitlines()
    head, *rows = [[word.strip() for word in line.split("|")] for line in table]
    ratios = {row[1]: float(row[head.index("pose ratio")]) for row in rows[1:]}
    overall = float(re.findall(r"Pose ratio overall[^*]*\*\*([\d.]+)", text)[0])
    guide = (ROOT / "docs" / "user-guide.md").read_text(encoding="utf-8")
    assert f"by {min(ratios.values()):.2f} (humans) to {max(ratios.values()):.1f} (a bear)" in guide
    assert f"{overall:.2f} overall" in guide


def test_the_evaluation_page_has_a_row_for_every_method():
    from addon.evaluation.methods import DEFAULT

    tables = (ROOT / "docs" / "evaluation.md").read_text(encoding="utf-8").split("<!-- ")
    for mark in ("native", "coarse"):
        table = next(each for each in tables if each.startswith(f"{mark} -->"))
        assert set(DEFAULT) <= set(re.findall(r"^\| ([\w-]+) \|", table, flags=re.MULTILINE)), mark
