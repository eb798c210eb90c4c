"""The docs say what the code does."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from addon.core import Settings
from addon.core.methods.local_features import _SMOOTHING

ROOT = Path(__file__).resolve().parents[1]


def test_the_api_pages_are_up_to_date():
    done = subprocess.run(
        [sys.executable, "tools/api_reference.py", "--check"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def slugs(page: Path) -> set[str]:
    """Return the anchors of a page's headings, where GitHub and the site agree on them."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    plain = [
        re.sub(r"[^\w\s-]", "", heading.lower()).strip() for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    ]
    return {re.sub(r"\s", "-", each) for each in plain} & {re.sub(r"[-\s]+", "-", each) for each in plain}


@pytest.mark.parametrize("page", ["README.md", *(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/**/*.md"))])
def test_links_lead_somewhere(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for link, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", text):
        if not link.startswith(("http", "mailto:")):
            target = (ROOT / page).parent / link if link else ROOT / page
            assert target.stat().st_size > 0, link
            assert not anchor or target.suffix != ".md" or anchor in slugs(target), f"{link}#{anchor}"


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
    assert f"smoothing {_SMOOTHING}" in text


def test_the_core_imports_no_blender_and_files_stay_small():
    for path in (ROOT / "addon").rglob("*.py"):
        text = path.read_text()
        assert "core" not in path.parts or not re.search(r"^\s*(import|from) bpy", text, flags=re.MULTILINE), path
        assert text.count("\n") <= 400, path


def test_every_operator_and_panel_option_is_in_the_guides():
    from addon.interface import properties

    options = (ROOT / "docs" / "options.md").read_text(encoding="utf-8")
    scripting = (ROOT / "docs" / "scripting.md").read_text(encoding="utf-8")
    for owner in (properties.MethodProperties, properties.RequestProperties):
        for definition in owner.__annotations__.values():
            name = definition.keywords["name"]
            assert name in options or name == "Vertex Group", name
    source = "".join(path.read_text() for path in (ROOT / "addon" / "interface").glob("*.py"))
    for name in re.findall(r'bl_idname = "object\.(\w+)"', source):
        if name not in ("canonical_form_cancel", "canonical_form_choose", "canonical_form_read"):
            assert f"bpy.ops.object.{name}(" in scripting, name


def test_times_and_ratios_told_elsewhere_agree_with_the_results():
    records = json.loads((ROOT / "docs" / "results.json").read_text(encoding="utf-8"))
    seconds = {int(row["setting"]): row["seconds"] for row in records["scale"]["rows"]}
    assert seconds[10_000] < 1.5  # about a second
    assert seconds[160_000] == pytest.approx(4, rel=0.25)
    assert seconds[1_000_000] == pytest.approx(30, rel=0.25)
    for page in ("README.md", "docs/user-guide.md"):
        told = " ".join((ROOT / page).read_text(encoding="utf-8").split())
        assert re.search(r"four for 160,000,? (and )?half a minute for a million", told), page
    ratios = {row["mesh"]: row["pose ratio"] for row in records["quality"]["rows"] if row["setting"] == "straight"}
    told = " ".join((ROOT / "docs" / "canonical-form.md").read_text(encoding="utf-8").split())
    assert "About a quarter of the difference between two poses" in told
    assert "a sixth for people, half for a bear" in told
    assert np.mean(list(ratios.values())) == pytest.approx(1 / 4, rel=0.15)
    assert ratios["man"] == pytest.approx(1 / 6, rel=0.15)
    assert ratios["woman"] == pytest.approx(1 / 6, rel=0.15)
    assert ratios["bear"] == max(ratios.values()) == pytest.approx(1 / 2, rel=0.1)


def test_the_first_form_fits_on_one_page():
    text = (ROOT / "docs" / "user-guide.md").read_text(encoding="utf-8")
    assert len(text.split()) <= 700
    assert text.count("![") == 3


def test_the_first_page_leads_to_every_task():
    text = (ROOT / "docs" / "user-guide.md").read_text(encoding="utf-8")
    for page in (ROOT / "docs" / "tasks").glob("*.md"):
        assert f"(tasks/{page.name})" in text, page.name
        assert "## What can go wrong" in page.read_text(encoding="utf-8"), page.name


def test_the_evaluation_page_has_a_row_for_every_method():
    from addon.evaluation.methods import DEFAULT

    text = (ROOT / "docs" / "evaluation.md").read_text(encoding="utf-8")
    records = json.loads((ROOT / "docs" / "results.json").read_text(encoding="utf-8"))
    measured = {row["method"] for row in records["evaluation"]["rows"]}
    read = {f"as-published{'-closed' if row['cells'] == 'closed' else ''}" for row in records["readings"]["rows"]}
    assert set(DEFAULT) <= measured | read
    assert measured <= set(re.findall(r"^\| ([\w-]+) \|", text, flags=re.MULTILINE))
    for row in records["evaluation"]["rows"]:  # the page's digest is that of the record
        ratio = f"{row['pose ratio']:.2f}".removeprefix("0")
        assert f"| {row['method']} | {ratio} |" in text, row["method"]
