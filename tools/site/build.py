"""Builds the site, a folder for any web server with the documents and a repository for Blender: `make site`.

With ``--pages`` the repository is left out, as it needs the wheels of all platforms.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tools import package  # noqa: E402
from tools.site.pages import gather  # noqa: E402
from tools.site.repository import make_repository  # noqa: E402


def main(pages_only: bool) -> None:
    here = Path(__file__).parent
    gathered = gather(ROOT, ROOT / "build" / "site-pages")
    package.tell([sys.executable, "-m", "mkdocs", "build", "--config-file", here / "mkdocs.yml"])
    site = ROOT / "build" / "site"
    print(f"{site}: {len(gathered)} pages")
    if not pages_only:
        package.main(here=False)
        for each in make_repository(package.by_python(here=False), site / "repository"):
            fits = ", ".join([*each["platforms"], *(f"Python {python}" for python in each["python_versions"])])
            size = each["archive_size"] / 1e6
            print(f"{site / 'repository'}: {each['id']} {each['version']} for {fits}, {size:.0f} MB")
    subprocess.run(["du", "-sh", site], check=False)


if __name__ == "__main__":
    main("--pages" in sys.argv)
