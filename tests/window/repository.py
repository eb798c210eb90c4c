"""The extension from a repository of this machine, installed and updated by mouse in Blender's preferences.

``python tests/window/run.py --session tests/window/repository.py``. A server shows a repository with version 0.9.0;
then, with a form in the file, one with 1.0.0.
"""

import functools
import http.server
import re
import shutil
import subprocess
import sys
import threading
import zipfile
from pathlib import Path
from time import perf_counter

import bpy

PACKAGE, PICTURES = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :][:2])
sys.path[:0] = [str(Path(__file__).resolve().parents[2])]

from tests.window.driving import drive  # noqa: E402
from tests.window.hand import Hand  # noqa: E402

FOLDER = PICTURES.parent / "served"
hand = Hand(PICTURES)


def serve():
    """Serve the folder; return the address of its index."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(FOLDER))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/index.json"


def publish(version):
    """Put the package into the folder under a version, and let Blender write the index."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    with (
        zipfile.ZipFile(PACKAGE) as old,
        zipfile.ZipFile(FOLDER / f"canonical_form-{version}.zip", "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for each in old.infolist():
            data = old.read(each)
            if each.filename == "blender_manifest.toml":
                data = re.sub(rb'^version = ".*"', f'version = "{version}"'.encode(), data, flags=re.MULTILINE)
            new.writestr(each, data)
    command = [bpy.app.binary_path, "--background", "--command", "extension", "server-generate"]
    subprocess.run([*command, f"--repo-dir={FOLDER}"], check=True)


def installed():
    """The version that lies in the folder of the repository; None where none does."""
    import tomllib

    for repo in bpy.context.preferences.extensions.repos:
        manifest = Path(repo.directory) / "canonical_form" / "blender_manifest.toml"
        if repo.name == "Here" and manifest.exists():
            return str(tomllib.loads(manifest.read_text(encoding="utf-8"))["version"])
    return None


def session():
    """Add the repository, install 0.9.0, compute, update to 1.0.0, clear."""
    publish("0.9.0")
    from tools.sample.posed_figure import build

    bpy.data.batch_remove([*bpy.data.objects])
    bpy.context.view_layer.update()
    build(levels=2)
    figure = next(obj for obj in bpy.data.objects if obj.type == "MESH")
    bpy.context.view_layer.objects.active = figure
    preferences = bpy.context.preferences
    preferences.system.use_online_access = True
    preferences.extensions.repos.remove(preferences.extensions.repos["extensions.blender.org"])  # not to be reached
    bpy.ops.preferences.extension_repo_add(name="Here", remote_url=serve(), type="REMOTE")
    area = hand.area()
    area.ui_type = "PREFERENCES"
    preferences.active_section = "EXTENSIONS"
    bpy.context.window_manager.extension_search = "canonical"
    yield 1.0
    bpy.ops.extensions.repo_sync_all()
    yield 5.0
    yield from hand.move(area.x + 300, area.y + 60)
    yield from hand.key("ESC")  # the splash screen
    yield 1.0
    yield from hand.picture("repository-1-offered")
    yield from press_until(area, lambda: installed() == "0.9.0")
    yield 3.0
    yield from hand.picture("repository-2-installed")
    assert hasattr(bpy.types, "OBJECT_OT_canonical_form"), "installed, and not enabled"
    assert bpy.ops.object.canonical_form() == {"FINISHED"}
    before = [tuple(point.co) for point in figure.data.shape_keys.key_blocks["Canonical Form"].data]
    publish("1.0.0")
    bpy.ops.extensions.repo_sync_all()
    yield 5.0
    yield from hand.picture("repository-3-update-offered")
    yield from press_until(area, lambda: installed() == "1.0.0")
    yield 3.0
    yield from hand.picture("repository-4-updated")
    assert hasattr(bpy.types, "OBJECT_OT_canonical_form"), "updated, and not enabled"
    after = [tuple(point.co) for point in figure.data.shape_keys.key_blocks["Canonical Form"].data]
    assert before == after
    assert bpy.ops.object.canonical_form() == {"FINISHED"}
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert figure.data.shape_keys is None
    area.ui_type = "VIEW_3D"
    yield 1.0
    yield from hand.picture("repository-5-cleared")


def press_until(area, happened):
    """Click down the right side of the list of extensions, where the button is, until something has happened."""
    region = next(region for region in area.regions if region.type == "WINDOW")
    for below in range(70, 260, 10):
        yield from hand.click(region.x + region.width - 80, region.y + region.height - below)
        began = perf_counter()
        while perf_counter() - began < 5.0:
            if happened():
                return
            area.tag_redraw()  # Blender's installer goes on with the events of its window
            yield 0.1
    raise AssertionError("no click did it")


drive(session(), "REPOSITORY SESSION PASSED")
