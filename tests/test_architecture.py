"""The house stands: rooms use only rooms below them, no circles, no file past its size, no Blender in the core."""

import ast
import re
import shutil
import subprocess
import sys
import textwrap
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CORE, BLENDER = ROOT / "addon" / "core", ROOT / "addon" / "blender"
LAYERS = ("core", "blender", "interface")  # of the extension, from the ground up


def imports_of(path, root):
    """Files of the package that a file imports, as dotted names from `root`, wherever the import stands."""
    package = list(path.relative_to(root).with_suffix("").parts[:-1])
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[: len(package) - node.level + 1] + (node.module.split(".") if node.module else [])
            target = root.joinpath(*base)
            for each in node.names:
                inside = (target / each.name).is_dir() or (target / f"{each.name}.py").is_file()
                yield ".".join([*base, each.name] if inside else base)


def rooms_of(layer):
    """Rooms of a layer from the ground up, as its README lists them."""
    return re.findall(r"^\| `(\w+)` \|", (layer / "README.md").read_text(encoding="utf-8"), flags=re.MULTILINE)


def upward_arrows(layer):
    """Imports from a room to one above it, or to a file beside the rooms."""
    rooms, found = rooms_of(layer), []
    for path in sorted(layer.rglob("*.py")):
        room = path.relative_to(layer).parts[0]
        for target in imports_of(path, layer.parent):
            name, *inside = target.split(".")
            if room not in rooms or name != layer.name:
                continue
            if inside[0] not in rooms or rooms.index(inside[0]) > rooms.index(room):
                found.append(f"{path.relative_to(layer).as_posix()} imports {'.'.join(inside)}")
    return found


@pytest.mark.parametrize("layer", [CORE, BLENDER], ids=lambda layer: layer.name)
def test_the_readme_lists_every_room(layer):
    folders = {path.name for path in layer.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(rooms_of(layer))


@pytest.mark.parametrize("layer", [CORE, BLENDER], ids=lambda layer: layer.name)
def test_a_room_says_what_its_row_says(layer):
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", (layer / "README.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    for room, says in rows:
        text = (layer / room / "__init__.py").read_text(encoding="utf-8")
        assert text == f'"""{says[0].upper()}{says[1:]}."""\n'


@pytest.mark.parametrize("layer", [CORE, BLENDER], ids=lambda layer: layer.name)
def test_no_room_imports_one_above_it(layer):
    assert upward_arrows(layer) == []


def test_an_upward_import_is_found(tmp_path):
    core = tmp_path / "core"
    shutil.copytree(CORE, core, ignore=shutil.ignore_patterns("__pycache__"))
    heat = core / "distances" / "heat.py"
    heat.write_text("from ..embedding.smacof import smacof\n" + heat.read_text(encoding="utf-8"), encoding="utf-8")
    assert upward_arrows(core) == ["distances/heat.py imports embedding.smacof"]


def test_no_file_of_the_extension_imports_in_a_circle():
    addon = ROOT / "addon"
    graph = {}
    for path in addon.rglob("*.py"):
        name = ".".join(path.relative_to(addon).with_suffix("").parts).removesuffix(".__init__")
        graph[name] = {each for each in imports_of(path, addon) if each != name}
    tuple(TopologicalSorter(graph).static_order())


def test_layers_of_the_extension_are_one_way():
    addon = ROOT / "addon"
    for number, layer in enumerate(LAYERS):
        for path in (addon / layer).rglob("*.py"):
            above = {each.split(".")[0] for each in imports_of(path, addon)} & set(LAYERS[number + 1 :])
            assert not above, f"{path} imports {above}"


def test_the_core_imports_no_blender_and_names_no_menu():
    for path in CORE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"^\s*(import|from) bpy", text, flags=re.MULTILINE), path
        assert not re.search(r"(Mesh|Object|Edit Mode|Select|File) > \w", text), path


@pytest.mark.parametrize("folder", ["addon", "tests", "tools"])
def test_files_stay_small(folder):
    for path in (ROOT / folder).rglob("*.py"):
        assert path.read_text(encoding="utf-8").count("\n") <= 400, path


def test_the_roots_of_the_layers_stay_short():
    assert len(list(CORE.glob("*.py"))) <= 12
    assert [path.name for path in BLENDER.glob("*.py")] == ["__init__.py"]


def test_no_two_methods_have_one_rank():
    from addon.core.method_api.catalogue import methods

    ranks = [each.rank for each in methods().values()]
    assert len(set(ranks)) == len(ranks)


NEW_METHOD = '''
"""Every vertex as far from the centre as on a ball: a method of 30 lines."""

import numpy as np

from ..method_api.catalogue import Method
from ..method_api.method_result import MethodResult


def ball_form(found, settings, monitor):
    """Put all vertices onto a ball."""
    with monitor.stage("Embedding"):
        away = found.whole_points - found.whole_points.mean(axis=0)
        form = away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-12)
        return MethodResult(form, np.zeros(1), 0)


METHODS = (
    Method(
        name="ball",
        label="Ball",
        help="All vertices at one distance from the centre",
        source="a test",
        unfold=ball_form,
        stages={"Embedding": 1},
        rank=99,
    ),
)
'''


def test_a_new_method_is_one_new_file(tmp_path):
    shutil.copytree(ROOT / "addon", tmp_path / "addon", ignore=shutil.ignore_patterns("__pycache__"))
    assert NEW_METHOD.count("\n") <= 30
    (tmp_path / "addon" / "core" / "methods" / "ball.py").write_text(NEW_METHOD.lstrip(), encoding="utf-8")
    script = """
        import sys
        import numpy as np
        from addon.core import Settings, canonical_form
        from addon.evaluation.methods import KNOWN
        tetrahedron = np.array([[0, 0, 0], [3, 0, 0], [0, 1, 0], [0, 0, 1.0]])
        form = canonical_form(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], Settings(method="ball"))
        radius = np.linalg.norm(form.vertices - form.vertices.mean(axis=0), axis=1)
        assert "ball" in KNOWN
        try:
            import bpy
        except ImportError:
            print("ball in everything but Blender")
        else:
            from addon.batch.command import main
            from addon.interface.properties import method_items
            assert "ball" in [item[0] for item in method_items(None, None)]
            assert main(["compute", "--help"], sys.stdout) == 0
        """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "ball" in done.stdout
