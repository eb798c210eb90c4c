"""Builds the extension: `make package`.

Downloads the scipy wheels that the manifest lists, and runs Blender's own builder, which writes one zip per platform
to `build/`, to be installed from disk. With ``--here`` only the Linux wheels are downloaded and one zip is written to
`build/here/`, for tests. A repository has lighter ones, of one wheel each (`by_python`). All have the artist's pages.
"""

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tools.guide import write_guide  # noqa: E402

BUILD = ROOT / "build"
MANIFEST = ROOT / "blender_manifest.toml"
PLATFORMS = {  # of Blender, by what names of wheels have of them
    "linux-x64": "manylinux",
    "windows-x64": "win_amd64",
    "macos-arm64": "arm64",
    "macos-x64": "macosx_10_13_x86_64",
}
FIRST = {"cp313": "4.3.0", "cp314": "4.3.0"}  # Blender 4.2 does not ask for which Python a zip is


def main(here: bool) -> list[Path]:
    """Build a zip for each platform, or for this one, with the wheels of all Pythons; return their paths."""
    described = tomllib.loads(MANIFEST.read_text())
    wheels = [Path(wheel).name for wheel in described["wheels"]]
    platforms = described["platforms"]
    if here:
        wheels, platforms = [wheel for wheel in wheels if "manylinux" in wheel], ["linux-x64"]
    fetch(wheels, BUILD / "wheels")
    return build(wheels, platforms, BUILD / "here" if here else BUILD)


def by_python(here: bool) -> list[Path]:
    """Build a zip for each platform and Python, with one wheel; Blender takes from a repository the one that fits."""
    described = tomllib.loads(MANIFEST.read_text())
    output = BUILD / ("here-by-python" if here else "by-python")
    shutil.rmtree(output, ignore_errors=True)
    zips = []
    for wheel in (Path(each).name for each in described["wheels"]):
        python = wheel.split("-")[2]
        platform = next(name for name, part in PLATFORMS.items() if part in wheel)
        if here and platform != "linux-x64":
            continue
        fetch([wheel], BUILD / "wheels")
        (built,) = build([wheel], [platform], output / "new", first=FIRST.get(python))
        target = output / built.name.replace(".zip", f"-py{python[2:]}-{platform.replace('-', '_')}.zip")
        zips.append(built.rename(target))
    (output / "new").rmdir()
    return zips


def build(wheels: list[str], platforms: list[str], output: Path, *, first: str | None = None) -> list[Path]:
    """Build zips with some wheels, one for each platform; `first`: the first version of Blender that takes them."""
    manifest = MANIFEST.read_text()
    stage = BUILD / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    tracked = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "--", "__init__.py", "addon", "LICENSE"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout.split()  # fmt: skip
    for name in tracked:
        if name.startswith("addon/evaluation/") or name.endswith("py.typed"):  # for Python, from the source code
            continue
        (stage / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, stage / name)
    write_guide(stage / "addon" / "guide")
    (stage / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(BUILD / "wheels" / wheel, stage / "wheels" / wheel)
    kept = "".join(f'  "./wheels/{wheel}",\n' for wheel in wheels)
    manifest = re.sub(r"wheels = \[.*?\]", f"wheels = [\n{kept}]", manifest, flags=re.DOTALL)
    named = ", ".join(f'"{each}"' for each in platforms)
    manifest = re.sub(r"platforms = .*", f"platforms = [{named}]", manifest)
    if first is not None:
        manifest = re.sub(r"blender_version_min = .*", f'blender_version_min = "{first}"', manifest)
    (stage / "blender_manifest.toml").write_text(manifest)
    output.mkdir(parents=True, exist_ok=True)
    builder = blender_builder()
    split = ["--split-platforms"] if len(platforms) > 1 else []
    for old in output.glob("*.zip"):
        old.unlink()
    tell([sys.executable, builder, "build", f"--source-dir={stage}", f"--output-dir={output}", *split])
    zips = sorted(output.glob("*.zip"))
    for path in zips:
        tell([sys.executable, builder, "validate", path])
        check_content(path)
        print(f"{path}: {path.stat().st_size / 1e6:.0f} MB")
    return zips


def fetch(wheels: list[str], folder: Path) -> None:
    """Download the missing wheels."""
    for wheel in wheels:
        if (folder / wheel).exists():
            continue
        name, version, python, _, platform = wheel.removesuffix(".whl").split("-")
        tell([
            sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps",
            "--only-binary=:all:", f"--python-version={python[2:]}", "--implementation=cp",
            *(f"--platform={each}" for each in platform.split(".")), f"--dest={folder}", f"{name}=={version}",
        ])  # fmt: skip
        if not (folder / wheel).exists():
            sys.exit(f"The registry has no {wheel}.")


def blender_builder() -> Path:
    """Return Blender's own command-line tool for extensions, inside the bpy module."""
    import bpy

    found = sorted(Path(bpy.utils.resource_path("LOCAL")).rglob("bl_pkg/cli/blender_ext.py"))
    if not found:
        sys.exit("This bpy has no extension builder.")
    return found[0]


def check_content(path: Path) -> None:
    """Reject a zip with anything but code, languages, guide, manifest, licence and wheels, or with an empty folder."""
    names = zipfile.ZipFile(path).namelist()
    wanted = re.compile(
        r"(__init__\.py|blender_manifest\.toml|LICENSE|addon/(?!evaluation/).+\.py|addon/languages/\w+\.json"
        r"|addon/guide/.+\.(html|png|gif)"
        r"|wheels/.+\.whl)$"
    )
    odd = [name for name in names if not name.endswith("/") and not wanted.match(name)]
    if odd or "addon/core/canonical.py" not in names or not any(name.startswith("wheels/") for name in names):
        sys.exit(f"{path.name} does not hold what it should: {odd or names}")


def tell(command: list) -> None:
    """Run a command and stop if it fails."""
    done = subprocess.run(command)
    if done.returncode:
        sys.exit(f"Failed: {' '.join(map(str, command))}")


if __name__ == "__main__":
    main("--here" in sys.argv)
