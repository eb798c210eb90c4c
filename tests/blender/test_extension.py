"""The packed extension, installed by Blender's own installer into an empty home, in a process of its own.

From a zip, and from a repository as the site holds one, served by this machine.

``CANONICAL_FORM_PYTHONS`` names further interpreters with a bpy of their own, separated by colons.
"""

import functools
import http.server
import os
import re
import shutil
import subprocess
import sys
import threading
import zipfile
from pathlib import Path

import pytest

from tests.conftest import DATA
from tools.site.repository import make_repository

ROOT = Path(__file__).resolve().parents[2]
PYTHONS = [sys.executable, *filter(None, os.environ.get("CANONICAL_FORM_PYTHONS", "").split(":"))]

STEPS = """
import importlib, sys, time, bpy, addon_utils
zip_path, mesh_path = sys.argv[1:3]
name = "bl_ext.user_default.canonical_form"
bpy.ops.wm.read_factory_settings(use_empty=True)

MENUS = ("VIEW3D_MT_object", "VIEW3D_MT_edit_mesh", "VIEW3D_MT_paint_weight", "MESH_MT_vertex_group_context_menu")

def lasting():
    handlers = [each for each in dir(bpy.app.handlers) if isinstance(getattr(bpy.app.handlers, each), list)]
    menus = MENUS
    return {
        "types": set(dir(bpy.types)),
        "properties": {kind: set(getattr(bpy.types, kind).bl_rna.properties.keys()) for kind in
                       ("Scene", "Mesh", "Object", "WindowManager", "Screen", "Key")},
        "attributes": {kind: set(dir(getattr(bpy.types, kind))) for kind in ("Scene", "Mesh", "Object")},
        "handlers": {each: len(getattr(bpy.app.handlers, each)) for each in handlers},
        "menus": {each: len(getattr(getattr(bpy.types, each), "_dyn_ui_initialize")()) for each in menus},
        "subclasses": {each.__name__ for kind in (bpy.types.Operator, bpy.types.Panel, bpy.types.PropertyGroup,
                       bpy.types.UIList, bpy.types.AddonPreferences) for each in kind.__subclasses__()
                       if getattr(each, "is_registered", False)},
        "add-ons": set(bpy.context.preferences.addons.keys()),
    }

for menu in MENUS:
    getattr(bpy.types, menu)._dyn_ui_initialize()
before = lasting()
bpy.ops.extensions.package_install_files(filepath=zip_path, repo="user_default", enable_on_install=True)
assert hasattr(bpy.types.Object, "canonical_form")
assert not any(module.startswith("scipy") for module in sys.modules), "scipy is imported on first use"
if mesh_path:
    bpy.ops.wm.obj_import(filepath=mesh_path)
    obj = next(each for each in bpy.data.objects if each.type == "MESH")
    bpy.context.view_layer.objects.active = obj
    options = {}
else:
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.modifier_add(type="SUBSURF")
    bpy.context.object.modifiers[0].levels = 3
    bpy.ops.object.modifier_apply(modifier=bpy.context.object.modifiers[0].name)
    options = {"max_iterations": 3}
obj = bpy.context.object
began = time.perf_counter()
assert bpy.ops.object.canonical_form(**options) == {"FINISHED"}
took = time.perf_counter() - began
assert "Canonical Form" in obj.data.shape_keys.key_blocks
assert bpy.ops.object.canonical_form_limb(patch=1, only=True) == {"FINISHED"}
assert bpy.ops.object.canonical_form_in_betweens(count=2) == {"FINISHED"}
assert bpy.ops.object.canonical_form_select_patch(patch=1) == {"FINISHED"}
obj.data.vertices.foreach_set("select", [True] + [False] * (len(obj.data.vertices) - 1))  # a cube is one patch
assert bpy.ops.object.canonical_form_distance(kind="heat") == {"FINISHED"}
assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
assert obj.data.shape_keys is None
import numpy, scipy
addon_utils.disable(name, default_set=True)
after = lasting()
assert after == before, {kind: (before[kind], after[kind]) for kind in before if before[kind] != after[kind]}
for module in [each for each in sys.modules if each.startswith(name)]:
    del sys.modules[module]
began = time.perf_counter()
extension = importlib.import_module(name)  # what is ours of enabling; the rest is Blender unpacking wheels
extension.register()
enabling = time.perf_counter() - began
extension.unregister()
assert lasting() == before
addon_utils.enable(name, default_set=True)
assert hasattr(bpy.types.Object, "canonical_form")
repositories = [each.module for each in bpy.context.preferences.extensions.repos]
bpy.ops.extensions.package_uninstall(repo_index=repositories.index("user_default"), pkg_id="canonical_form")
assert not hasattr(bpy.types.Scene, "canonical_form")
assert lasting() == before
print("PASSED", f"| {bpy.app.version_string} | {sys.version_info.major}.{sys.version_info.minor} "
      f"| {numpy.__version__} | {scipy.__version__} | {took:.1f} s | {1000 * enabling:.0f} ms |", flush=True)
__import__("os")._exit(0)  # the module of Blender 4.5 hangs now and then as it ends
"""

FROM_REPOSITORY = """
import sys, bpy
url, wanted = sys.argv[1:3]
preferences = bpy.context.preferences
preferences.system.use_online_access = True
repositories = preferences.extensions.repos
if not any(each.remote_url == url for each in repositories):
    bpy.ops.preferences.extension_repo_add(name="Served", remote_url=url, type="REMOTE")
number = next(index for index, each in enumerate(repositories) if each.remote_url == url)
assert bpy.ops.extensions.repo_sync(repo_index=number) == {"FINISHED"}
done = bpy.ops.extensions.package_install(repo_index=number, pkg_id="canonical_form", enable_on_install=True)
assert done == {"FINISHED"}
name = f"bl_ext.{repositories[number].module}.canonical_form"
import addon_utils
version = next(module.bl_info["version"] for module in addon_utils.modules() if module.__name__ == name)
assert version == tuple(map(int, wanted.split("."))), version
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.modifier_add(type="SUBSURF")
bpy.context.object.modifiers[0].levels = 3
bpy.ops.object.modifier_apply(modifier=bpy.context.object.modifiers[0].name)
assert bpy.ops.object.canonical_form(max_iterations=3) == {"FINISHED"}
bpy.ops.wm.save_userpref()
print("INSTALLED", wanted, flush=True)
__import__("os")._exit(0)  # as above
"""


@pytest.fixture(scope="module")
def package():
    subprocess.run([sys.executable, "tools/package.py", "--here"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return next((ROOT / "build" / "here").glob("canonical_form-*.zip"))


@pytest.mark.parametrize("python", PYTHONS)
def test_it_installs_enables_runs_disables_and_uninstalls(package, tmp_path, python):
    mesh = DATA / "horse" / "bind.obj"
    done = subprocess.run(
        [python, "-c", STEPS, str(package), str(mesh) if mesh.is_file() else ""],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert "PASSED" in done.stdout, done.stdout + done.stderr
    assert "Traceback" not in done.stderr, done.stderr
    assert "olicy violation" not in done.stdout + done.stderr
    print(*[line for line in done.stdout.splitlines() if "PASSED" in line])


def renumbered(path, version):
    """Copy a packed extension as another version of it, into a folder of its own."""
    folder = path.parent / version
    folder.mkdir(exist_ok=True)
    target = folder / re.sub(r"-\d+\.\d+\.\d+", f"-{version}", path.name)
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(target, "w") as new:
        for each in old.infolist():
            data = old.read(each)
            if each.filename == "blender_manifest.toml":
                data = re.sub(rb'^version = ".*"', f'version = "{version}"'.encode(), data, flags=re.MULTILINE)
            new.writestr(each, data)
    return target


@pytest.fixture
def served(tmp_path):
    """A folder, and the address at which a web server of this machine shows it."""
    folder = tmp_path / "site"
    folder.mkdir()

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *words):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield folder, f"http://127.0.0.1:{server.server_port}/repository/index.json"
    server.shutdown()


@pytest.fixture(scope="module")
def lighter():
    """A zip for each Python."""
    from tools.package import by_python

    return by_python(here=True)


def test_blender_installs_from_the_repository_of_the_site_and_updates(lighter, served, tmp_path):
    folder, url = served
    for version in ("0.9.0", "1.0.0"):
        zips = [renumbered(Path(shutil.copy(each, tmp_path)), version) for each in lighter]
        told = make_repository(zips, folder / "repository")
        assert {each["version"] for each in told} == {version}
        assert sorted(each["python_versions"] for each in told) == [["3.11"], ["3.13"], ["3.14"]]
        assert all(each["archive_size"] < 60e6 for each in told)
        home = tmp_path / "home"
        home.mkdir(exist_ok=True)
        done = subprocess.run(
            [sys.executable, "-c", FROM_REPOSITORY, url, version],
            env={**os.environ, "BLENDER_USER_RESOURCES": str(home)}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert f"INSTALLED {version}" in done.stdout, done.stdout + done.stderr
        assert "Traceback" not in done.stderr, done.stderr
