"""Draws the rooms of the core for docs/architecture.md: `make rooms-picture`.

Rooms are stacked in the order of addon/core/README.md; arrows lead from a room to those that it imports.
"""

import ast
import re
import sys
import textwrap
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
CORE = ROOT / "addon" / "core"
TARGET = ROOT / "docs" / "pictures" / "rooms.png"
COLUMNS = {  # horizontal positions of the rooms; the vertical position is the floor
    "doors": 1.5, "methods": 1.5, "method_api": 1.5, "posing": 0.0, "embedding": 1.5, "measures": 3.0,
    "deformation": 0.0, "distances": 1.5, "detection": 3.0, "assembly": 0.0, "surface": 1.5, "patching": 3.0,
    "mesh": 1.5, "numerics": 1.5, "run": 1.5, "symmetry": 4.5, "matching": 3.0, "modelling": 4.5,
    "placing": 3.0, "stress": 0.0,
}  # fmt: skip
DOORS = "canonical_form, match, pose_like, limb_shapes, distance_field …"
WIDE, HIGH = 1.3, 0.7


def arrows() -> dict[str, set[str]]:
    """Return the rooms that each room imports."""
    uses: dict[str, set[str]] = {}
    for path in CORE.rglob("*.py"):
        parts = path.relative_to(CORE).parts
        room = parts[0] if len(parts) > 1 else "doors"
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ImportFrom) and node.module and node.level == len(parts):
                other = node.module.split(".")[0]
                if (CORE / other).is_dir() and other != room:
                    uses.setdefault(room, set()).add(other)
    uses["doors"].add("methods")  # by name, through the catalogue
    return uses


def floors(uses: dict[str, set[str]]) -> dict[str, int]:
    """Return the floor of each room: one above the highest room that it imports."""
    known: dict[str, int] = {}

    def floor(room: str) -> int:
        if room not in known:
            known[room] = 1 + max((floor(other) for other in uses.get(room, ())), default=-1)
        return known[room]

    for room in COLUMNS:
        floor(room)
    return known


def main() -> None:
    uses = arrows()
    height = floors(uses)
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", (CORE / "README.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    says = {
        room: "\n".join(textwrap.wrap(text, 32, max_lines=3, placeholder=" …"))
        for room, text in [("doors", DOORS), *rows]
    }
    figure, axes = plt.subplots(figsize=(13, 11))
    for room, others in uses.items():
        direct = others - {far for near in others for far in reach(near, uses)}  # indirect imports are not drawn
        for other in sorted(direct):
            start = (COLUMNS[room], height[room] - HIGH / 2)
            axes.annotate(
                "", (COLUMNS[other], height[other] + HIGH / 2), start,
                arrowprops={"arrowstyle": "-|>", "color": "0.55", "lw": 1.1, "shrinkA": 0, "shrinkB": 0}, zorder=0,
            )  # fmt: skip
    for room, column in COLUMNS.items():
        colour = "#f2d7b0" if room == "doors" else "#d6e7ed"
        corner = (column - WIDE / 2, height[room] - HIGH / 2)
        axes.add_patch(plt.Rectangle(corner, WIDE, HIGH, facecolor=colour, edgecolor="0.4"))
        axes.text(column, height[room] + 0.17, room, ha="center", va="center", fontsize=13, weight="bold")
        axes.text(column, height[room] - 0.11, says[room], ha="center", va="center", fontsize=8, linespacing=1.2)
    axes.set_xlim(-0.7, 5.2)
    axes.set_ylim(-0.5, max(height.values()) + 0.5)
    axes.axis("off")
    figure.tight_layout()
    figure.savefig(TARGET, dpi=80)
    print(TARGET)


def reach(room: str, uses: dict[str, set[str]]) -> set[str]:
    """Return all rooms that a room needs, directly or indirectly."""
    near = uses.get(room, set())
    return near | {far for other in near for far in reach(other, uses)}


if __name__ == "__main__":
    main()
