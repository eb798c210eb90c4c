"""Draws the figures of the paper with our own results: ``make figures [DATA=folder]``.

DATA is a folder with one subfolder per shape and one .obj per pose; if omitted, that of CANONICAL_FORM_DATA, or the
figures of the tests.
"""

import json
import os
import sys
from pathlib import Path

import matplotlib as mpl

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
mpl.use("Agg")

from tools.figures import features, fields, galleries, overview, swiss_roll, t_poses  # noqa: E402
from tools.figures.models import models  # noqa: E402

FIGURES = {
    "1-feature-points": features.draw,
    "2-swiss-roll": swiss_roll.draw,
    "3-fields": fields.draw,
    "4-overview": overview.draw,
    "5-poses": galleries.draw_poses,
    "6-methods": galleries.draw_methods,
    "../contact-sheet": galleries.draw_contact_sheet,
    "../t-poses": t_poses.draw,
}


def main(data=None, only=""):
    named = data or os.environ.get("CANONICAL_FORM_DATA")
    found = models(Path(named) if named else None)
    folder = ROOT / "docs" / "pictures" / "paper"
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in FIGURES.items():
        if only and only not in name:
            continue
        figure, numbers = draw(found)
        path = folder / f"{name}.png"
        figure.savefig(path, dpi=100, metadata={"Software": None})
        print(f"{path.resolve().relative_to(ROOT)}: {json.dumps(numbers)}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
