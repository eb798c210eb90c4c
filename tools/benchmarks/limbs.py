"""One limb at a time and in-betweens, on any folder of posed meshes: ``limbs.py FOLDER``."""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import canonical_form  # noqa: E402
from addon.core.limbs import limb_shapes  # noqa: E402
from addon.core.measures.alignment import rigid_fit  # noqa: E402
from addon.core.measures.form_measures import edge_stretch  # noqa: E402
from addon.core.mesh.edges import vertex_pairs  # noqa: E402
from addon.core.mesh.geometry import signed_volume  # noqa: E402
from addon.core.posing.articulation import Articulation  # noqa: E402
from addon.core.posing.limb_amounts import limb_amounts  # noqa: E402
from tests.meshes import shapes  # noqa: E402


def main(folder: Path) -> None:
    print("| bent limb | in-between | plain blend |\n| --- | --- | --- |")
    for degrees in (60, 90, 120, 150):
        points, faces = shapes.joint(degrees)
        straight = shapes.joint(0)[0]
        rotation, shift = rigid_fit(straight, points)
        straight = straight @ rotation + shift
        volume = signed_volume(points, faces)
        halfway = signed_volume(Articulation(points, faces, straight).at(0.5), faces) / volume - 1
        blend = signed_volume((points + straight) / 2, faces) / volume - 1
        print(f"| {degrees}° | {halfway:+.2%} | {blend:+.1%} |")
    print("\n| shape | pose | whole form, 99th % | bands, 99th %, worst | largest in a band | moved outside |", end="")
    print(" volume, in-between | volume, plain blend |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    for path in sorted(folder.glob("*/*.obj")):
        points, faces = shapes.read_obj(path)
        found = canonical_form(points, faces)
        whole = np.quantile(np.abs(edge_stretch(points, found.vertices, faces) - 1), 0.99)
        bands, largest, outside = [], 0.0, 0.0
        for patch in range(len(found.feature_points)):
            chosen = found.patches == patch
            shape, amounts = limb_shapes(points, faces, found.vertices, chosen)[0], limb_amounts(points, faces, chosen)
            band = ((amounts > 0) & (amounts < 1))[vertex_pairs(faces)].any(axis=1)
            stretch = np.abs(edge_stretch(points, shape, faces) - 1)[band]
            bands.append(np.quantile(stretch, 0.99))
            largest = max(largest, stretch.max())
            outside = max(outside, np.abs(shape - points)[amounts == 0].max() / np.ptp(points, axis=0).max())
        volume = signed_volume(points, faces)
        halfway = signed_volume(Articulation(points, faces, found.vertices).at(0.5), faces) / volume - 1
        blend = signed_volume((points + found.vertices) / 2, faces) / volume - 1
        print(
            f"| {path.parent.name} | {path.stem} | {whole:.1%} | {max(bands):.1%} | {largest:.1%} | {outside:.0e} |"
            f" {halfway:+.1%} | {blend:+.1%} |",
            flush=True,
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
