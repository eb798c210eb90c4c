"""Characters with very many small pieces: ``many_pieces.py FILE.glb``, a rigged character on whose skin scales are put.

For each number of scales: vertices, pieces, feature points, how far the skin's form is from that without scales, how
far the middle of a scale moves relative to the skin under it (both in sqrt(area)), seconds and their ratio.
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core.assembly.pieces import connected_pieces  # noqa: E402
from addon.core.mesh.geometry import surface_area  # noqa: E402
from tests.meshes.pieced import with_scales  # noqa: E402
from tools.benchmarks.characters import posed, timed  # noqa: E402
from tools.benchmarks.two_meshes import distance  # noqa: E402

COUNTS = 0, 100, 400, 1000, 3000, 9000
HEIGHT = 0.004


def main(file: Path) -> None:
    print("| scales | vertices | pieces | features | skin, RMS | scale, 95 % | seconds | ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    poses, skin = posed(file, 2)
    bare, bare_seconds = quickest(poses[1], skin)
    for count in COUNTS:
        vertices, faces, under = with_scales(poses[1], skin, min(count, len(skin)), HEIGHT)
        form, seconds = quickest(vertices, faces)
        apart = distance(form.vertices[: len(poses[1])], bare.vertices) / np.sqrt(surface_area(bare.vertices, skin))
        print(
            f"| {len(under):,} | {len(vertices):,} | {len(connected_pieces(vertices, faces).pieces):,} |"
            f" {len(form.feature_points)} | {apart:.3f} |"
            f" {lifted(form.vertices, skin, under):.4f} | {seconds:.1f} | {seconds / bare_seconds:.2f} |",
            flush=True,
        )


def quickest(vertices, faces):
    return min((timed(vertices, faces) for _ in range(2)), key=lambda run: run[1])


def lifted(form, skin, under) -> float:
    """The change of the distance between the scales and the middles of the triangles under them, 95th percentile."""
    if not len(under):
        return 0.0
    middle = form[skin[under]].mean(axis=1)
    scales = form[-4 * len(under) :].reshape(-1, 4, 3).mean(axis=1)
    unit = np.sqrt(surface_area(form, skin))
    return float(np.quantile(np.abs(np.linalg.norm(scales - middle, axis=1) / unit - HEIGHT), 0.95))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
