"""Draws the rooms of the core for docs/architecture.md: `make rooms-picture`.

Rooms are stacked by what they import; arrows lead from a room to those that it imports.
"""

import re
import sys
import textwrap
from graphlib import TopologicalSorter
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.test_architecture import CORE, imports_of  # noqa: E402

TARGET = ROOT / "docs" / "pictures" / "rooms.png"
DOORS = ("doors", "canonical_form, match, pose_like, limb_shapes, distance_field …")
STEP, WIDE, HIGH = 1.5, 1.3, 0.7


def arrows() -> dict[str, set[str]]:
    """Return the rooms that each room imports, without those that these import."""
    uses: dict[str, set[str]] = {"doors": {"methods"}}  # by name, through the catalogue
    for path in CORE.rglob("*.py"):
        parts = path.relative_to(CORE).parts
        others = {target.split(".")[1] for target in imports_of(path, CORE.parent) if target.startswith("core.")}
        room = parts[0] if len(parts) > 1 else "doors"
        uses.setdefault(room, set()).update(other for other in others if (CORE / other).is_dir() and other != room)
    further: dict[str, set[str]] = {}
    for room in TopologicalSorter(uses).static_order():
        further[room] = {far for near in uses[room] for far in uses[near] | further[near]}
    return {room: near - further[room] for room, near in uses.items()}


def main() -> None:
    uses = arrows()
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", (CORE / "README.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    place: dict[str, tuple[float, int]] = {}
    floors = TopologicalSorter(uses)
    floors.prepare()
    while floors.is_active():
        ready, floor = sorted(floors.get_ready()), len({height for _, height in place.values()})
        left = (1 - len(ready)) / 2 + 0.35 * (floor % 3)  # not right above each other: arrows pass beside rooms
        place |= {room: (STEP * (left + at), floor) for at, room in enumerate(ready)}
        floors.done(*ready)
    figure, axes = plt.subplots(figsize=(13, 11))
    for room, others in uses.items():
        for other in sorted(others):
            (x, y), (end, below) = place[room], place[other]
            axes.annotate("", (end, below + HIGH / 2), (x, y - HIGH / 2), zorder=0,
                          arrowprops={"arrowstyle": "-|>", "color": "0.55", "shrinkA": 0, "shrinkB": 0})  # fmt: skip
    for room, says in [DOORS, *rows]:
        x, y = place[room]
        colour = "#f2d7b0" if room == "doors" else "#d6e7ed"
        axes.add_patch(plt.Rectangle((x - WIDE / 2, y - HIGH / 2), WIDE, HIGH, facecolor=colour, edgecolor="0.4"))
        axes.text(x, y + 0.2, room, ha="center", va="center", fontsize=13, weight="bold")
        lines = "\n".join(textwrap.wrap(says, 32, max_lines=3, placeholder=" …"))
        axes.text(x, y - 0.1, lines, ha="center", va="center", fontsize=8, linespacing=1.2)
    axes.autoscale_view()
    axes.axis("off")
    figure.tight_layout()
    figure.savefig(TARGET, dpi=80)
    print(TARGET)


if __name__ == "__main__":
    main()
