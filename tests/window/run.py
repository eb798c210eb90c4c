"""Runs a session in a real Blender with a window: `make test-window`.

Takes the Blender that ``BLENDER=`` names, or the one on the path. Without one, on a Debian-like machine as root, it
makes a Debian with Blender in a folder of its own (90 seconds, 2 GB; ``CANONICAL_FORM_BLENDER_ROOT`` moves it, and
``CANONICAL_FORM_DEBIAN=sid`` takes another Debian). Where no Blender can be had it says so and exits with 77.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "canonical-form"
SUITE = os.environ.get("CANONICAL_FORM_DEBIAN", "trixie")  # a Debian whose Blender is 4.2 or later
NAME = "blender-root" if SUITE == "trixie" else f"blender-root-{SUITE}"
OWN_ROOT = Path(os.environ.get("CANONICAL_FORM_BLENDER_ROOT", CACHE / NAME))
PACKAGES = ("blender", "python3-numpy", "xvfb", "xauth", "imagemagick", "libgl1-mesa-dri", "libegl1")
NO_BLENDER = 77
INSIDE = """
set -e
mount -t proc proc "$ROOT/proc"
for each in /sys /dev /tmp "$CHECKOUT" $EXTRA; do mkdir -p "$ROOT$each"; mount --rbind "$each" "$ROOT$each"; done
exec chroot "$ROOT" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 LIBGL_ALWAYS_SOFTWARE=1 \
  XDG_RUNTIME_DIR=/tmp BLENDER_USER_RESOURCES="$BLENDER_USER_RESOURCES" \
  CANONICAL_FORM_WALK="${CANONICAL_FORM_WALK:-1:500}" "$@"
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blender", default=os.environ.get("BLENDER") or "blender")
    parser.add_argument("--mesh", type=Path, help="an .obj to work on; the project's own figure when left out")
    parser.add_argument("--character", type=Path, help="a rigged .glb for the last step; one of our own when left out")
    parser.add_argument("--pictures", type=Path, default=ROOT / "build" / "pictures")
    parser.add_argument("--session", type=Path, default=ROOT / "tests" / "window" / "session.py")
    options = parser.parse_args()
    place = find(options.blender) or own_root()
    if place is None:
        print("No Blender 4.2 or later with a window can be had here; the window session was not run.", flush=True)
        return NO_BLENDER
    subprocess.run([sys.executable, ROOT / "tools" / "package.py", "--here"], check=True, stdout=subprocess.DEVNULL)
    package = next((ROOT / "build" / "here").glob("canonical_form-*.zip"))
    mesh = [each.resolve() for each in (options.mesh, options.character) if each]
    resources = ROOT / "build" / "window-home"
    shutil.rmtree(resources, ignore_errors=True)
    resources.mkdir(parents=True)
    options.pictures.mkdir(parents=True, exist_ok=True)
    command = [
        "--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0", "1280", "800",
        "--python", options.session.resolve(), "--", package, options.pictures.resolve(), *mesh,
    ]  # fmt: skip
    if not os.environ.get("DISPLAY") or isinstance(place, Path):
        screen = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24 +extension GLX"]
    else:
        screen = []
    if isinstance(place, Path):
        return inside(place, [*screen, "blender", *command], resources, [each.parent for each in mesh])
    return subprocess.run(
        [*screen, place, *command], env={**os.environ, "BLENDER_USER_RESOURCES": str(resources)}
    ).returncode


def find(name: str) -> str | None:
    """Find a program that is a Blender of 4.2 or later."""
    program = shutil.which(name)
    if program is None:
        return None
    told = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
    version = re.match(r"Blender (\d+)\.(\d+)", told)
    return program if version and tuple(map(int, version.groups())) >= (4, 2) else None


def own_root() -> Path | None:
    """Make a Debian with Blender in a folder, or find the one that was made before."""
    if (OWN_ROOT / "usr" / "bin" / "blender").exists():
        return OWN_ROOT
    if os.geteuid() != 0 or not shutil.which("apt-get") or not shutil.which("unshare"):
        return None
    print(f"Making a Debian with Blender in {OWN_ROOT} …", flush=True)
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.STDOUT}
    if not shutil.which("debootstrap"):
        subprocess.run(["apt-get", "update", "-q"], **quiet)
        subprocess.run(["apt-get", "install", "-y", "-q", "--no-install-recommends", "debootstrap"], **quiet)
    if not shutil.which("debootstrap"):
        return None
    script = Path("/usr/share/debootstrap/scripts") / SUITE
    if not script.exists():
        script.symlink_to("sid")
    sources = [Path("/etc/apt/sources.list"), *Path("/etc/apt/sources.list.d").glob("*")]
    text = "\n".join(path.read_text() for path in sources if path.is_file())
    mirror = re.findall(r"https?://[^\s]+/debian/?(?=\s)", text)[:1]
    OWN_ROOT.mkdir(parents=True, exist_ok=True)
    made = subprocess.run(
        ["debootstrap", "--variant=minbase", "--include=ca-certificates", SUITE, OWN_ROOT, *mirror], **quiet
    )
    if made.returncode:
        shutil.rmtree(OWN_ROOT, ignore_errors=True)
        return None
    for name in ("etc/resolv.conf", "etc/ssl/certs/ca-certificates.crt"):
        if Path("/", name).exists():
            shutil.copy(Path("/", name), OWN_ROOT / name)
    proxies = [f"{name}={value}" for name, value in os.environ.items() if name.lower().endswith("_proxy")]
    install = ["env", "DEBIAN_FRONTEND=noninteractive", *proxies, "apt-get", "install", "-y", "-q"]
    if inside(OWN_ROOT, [*install, "--no-install-recommends", *PACKAGES], OWN_ROOT / "tmp", [], quiet):
        shutil.rmtree(OWN_ROOT, ignore_errors=True)
        return None
    return OWN_ROOT


def inside(root: Path, command: list, resources: Path, extra: list[Path], quiet: dict | None = None) -> int:
    """Run a command in a Debian of its own; the mounts live as long as the command."""
    environment = {
        **os.environ,
        "ROOT": str(root),
        "CHECKOUT": str(ROOT),
        "EXTRA": " ".join(map(str, extra)),
        "BLENDER_USER_RESOURCES": str(resources),
    }
    return subprocess.run(
        ["unshare", "--mount", "--propagation", "private", "bash", "-c", INSIDE, "_", *map(str, command)],
        env=environment,
        **(quiet or {}),
    ).returncode


if __name__ == "__main__":
    sys.exit(main())
