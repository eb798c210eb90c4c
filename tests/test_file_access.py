"""What may not be read or written is told in one sentence before anything is computed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.meshes import shapes

ROOT = Path(__file__).resolve().parents[1]
ANYONE = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"]  # the superuser, for whom files are closed, too


def unprivileged():
    """Words before a command that make permissions count; None where that cannot be."""
    if not hasattr(os, "geteuid"):
        return None
    if os.geteuid():
        return []
    if (
        shutil.which(ANYONE[0]) is None
        or subprocess.run([*ANYONE, "true"], check=False, capture_output=True).returncode
    ):
        return None
    return ANYONE


@pytest.fixture
def closed(tmp_path):
    """A folder that nothing can be written to, a mesh, and one that may not be read."""
    if unprivileged() is None:
        pytest.skip("permissions do not count for this user")
    (tmp_path / "locked").mkdir()
    (tmp_path / "set" / "body").mkdir(parents=True)
    for name in ("set/body/mesh.off", "secret.off"):
        shapes.write_off(tmp_path / name, *shapes.figure(12))
    (tmp_path / "secret.off").chmod(0)
    (tmp_path / "locked").chmod(0o555)
    yield tmp_path
    (tmp_path / "locked").chmod(0o755)


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (
            ["compute", "set/body/mesh.off", "--output", "locked"],
            2,
            "Nothing can be written to locked: permission denied.",
        ),
        (["compute", "set/body/mesh.off", "--output", "locked/new"], 2, "locked/new for the results cannot be made"),
        (
            ["pose-like", "set/body/mesh.off", "--pose", "t", "--output", "locked"],
            2,
            "Nothing can be written to locked",
        ),
        (["match", "set/body/mesh.off", "secret.off", "--output", "locked"], 2, "Nothing can be written to locked"),
        (["evaluate", "set", "--output", "locked", "--methods", "euclidean-random"], 2, "Nothing can be written to"),
        (["compute", "secret.off", "--output", "out"], 1, "secret.off cannot be read: permission denied."),
        (
            ["compute", "set/body/mesh.off", "--reference", "secret.off", "--output", "out"],
            1,
            "secret.off cannot be read",
        ),
        (["match", "set/body/mesh.off", "secret.off", "--output", "out"], 1, "secret.off cannot be read"),
    ],
)
def test_closed_folders_and_files_are_told(words, code, sentence, closed):
    command = [*unprivileged(), sys.executable, "-m", "addon", *words]
    done = subprocess.run(command, cwd=closed, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True,
                          text=True, check=False)  # fmt: skip
    assert done.returncode == code
    assert sentence in done.stderr
    assert "Errno" not in done.stderr + done.stdout
    assert "Traceback" not in done.stderr
    assert len([line for line in done.stderr.splitlines() if line.startswith("canonical_form:")]) == 1
    assert list((closed / "locked").iterdir()) == []
