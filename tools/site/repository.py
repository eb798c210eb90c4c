"""A folder that Blender can use as a remote repository: the zips of the extension and their index."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

from tools.package import blender_builder


def make_repository(zips: list[Path], folder: Path) -> list[dict]:
    """Copy zips to a new folder, and write Blender's index of them, and a page to drag and drop the extension from.

    Returns the entry of each zip in the index. Raises ValueError if Blender's tool cannot read all of them.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for path in zips:
        shutil.copy(path, folder / path.name)
    command = [sys.executable, str(blender_builder()), "server-generate", f"--repo-dir={folder}", "--html"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(f"Blender's tool makes no index of {folder}: {done.stdout}{done.stderr}")
    told = json.loads((folder / "index.json").read_text(encoding="utf-8"))["data"]
    if {Path(each["archive_url"]).name for each in told} != {path.name for path in zips}:
        raise ValueError(f"The index of {folder} does not tell of every zip: {done.stdout}{done.stderr}")
    return told
