"""Creates the environment that `make run` and `make test` use: a `.venv` with bpy and the test tools.

Needs only Python 3.11 or 3.13. As root on a Debian-like system it also installs the packages that bpy and venv lack;
otherwise it prints the command.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / "tools" / "requirements.txt"
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
VERSIONS = ("3.11", "3.13")
LIBRARIES = {  # shared libraries that the bpy wheel needs and a minimal system lacks, and their Debian packages
    "libX11": "libx11-6",
    "libXi": "libxi6",
    "libXxf86vm": "libxxf86vm1",
    "libXfixes": "libxfixes3",
    "libXrender": "libxrender1",
    "libXext": "libxext6",
    "libxkbcommon": "libxkbcommon0",
    "libSM": "libsm6",
    "libICE": "libice6",
    "libGL": "libgl1",
    "libEGL": "libegl1",
    "libgomp": "libgomp1",
}


def main() -> None:
    stamp = VENV / ".made-from"
    wanted = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()
    if not (stamp.exists() and stamp.read_text() == wanted):
        make_venv(find_python())
        run([PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", REQUIREMENTS])
        stamp.write_text(wanted)
    for _ in range(len(LIBRARIES)):
        missing = missing_library()
        if missing is None:
            return
        install_packages([missing])
    sys.exit("bpy does not start; run .venv/bin/python -c 'import bpy' to see why.")


def find_python() -> str:
    named = [f"python{version}" for version in VERSIONS]
    for candidate in (sys.executable, *named, "python3"):
        answer = (
            subprocess.run(
                [candidate, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"], capture_output=True, text=True
            )
            if shutil.which(candidate)
            else None
        )
        if answer is not None and answer.returncode == 0 and answer.stdout.strip() in VERSIONS:
            return candidate
    sys.exit("Python 3.11 or 3.13 is needed: Blender as a module exists for these two.")


def make_venv(python: str) -> None:
    if VENV.is_symlink():
        sys.exit(f"{VENV} is a link to {VENV.readlink()}, whose packages are others. Remove the link first.")
    shutil.rmtree(VENV, ignore_errors=True)
    made = subprocess.run([python, "-m", "venv", VENV], capture_output=True, text=True)
    if made.returncode:
        version = subprocess.run(
            [python, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"], capture_output=True, text=True
        ).stdout.strip()
        install_packages([f"python{version}-venv"])
        shutil.rmtree(VENV, ignore_errors=True)
        run([python, "-m", "venv", VENV])


def missing_library() -> str | None:
    started = subprocess.run([PYTHON, "-c", "import bpy"], capture_output=True, text=True)
    if started.returncode == 0:
        return None
    named = re.search(r"(lib[A-Za-z0-9_+-]+)\.so", started.stderr)
    if named is None or named.group(1) not in LIBRARIES:
        sys.exit(started.stderr)
    return LIBRARIES[named.group(1)]


def install_packages(names: list[str]) -> None:
    command = ["apt-get", "install", "-y", "-q", "--no-install-recommends", *names]
    if os.geteuid() != 0 or not shutil.which("apt-get"):
        sys.exit(f"Missing on this machine: {', '.join(names)}. Install with: sudo {' '.join(command)}")
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    subprocess.run(["apt-get", "update", "-q"], env=quiet, stdout=subprocess.DEVNULL, check=False)
    subprocess.run(command, env=quiet, stdout=subprocess.DEVNULL, check=True)


def run(command: list) -> None:
    done = subprocess.run(command)
    if done.returncode:
        sys.exit(f"Failed: {' '.join(map(str, command))}")


if __name__ == "__main__":
    main()
