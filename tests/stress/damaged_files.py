"""Files of every kind that can be read, and damaged copies of them."""

import random
from pathlib import Path

from tests.meshes import pieced, shapes

NUMBERS = ["-1", "0", "1", "255", "256", "65536", "2147483647", "2147483648", "-2147483649", "9" * 30, "1e400", "-1e39",
           "nan", "inf", "-inf", "1e-320", "abc", "", "0x10", "1.5", "½", "1/2/3", "//", "-0", "1e", "\0"]  # fmt: skip
WORDS = [b"\0\0\0\0", b"\xff" * 4, b"\x7f\xff\xff\xff", b"\0\0\0\x80"]


def write_every_kind(folder: Path) -> list[Path]:
    """Write a tube and a body of several pieces to files of every kind, with Blender; return the files."""
    import bpy

    body = pieced.character()[2]
    for name, (vertices, faces) in {"tube": shapes.joint(60, 14, 7), "body": (body.vertices, body.faces)}.items():
        shapes.write_off(folder / f"{name}.off", vertices, faces)
        bpy.ops.wm.read_factory_settings(use_empty=True)
        mesh = bpy.data.meshes.new("Mesh")
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("Mesh", mesh))
        path = str(folder / name)
        bpy.ops.wm.obj_export(filepath=f"{path}.obj")
        for kind, ascii_format in (("text", True), ("binary", False)):
            bpy.ops.wm.ply_export(filepath=f"{path}-{kind}.ply", ascii_format=ascii_format)
            bpy.ops.wm.stl_export(filepath=f"{path}-{kind}.stl", ascii_format=ascii_format)
        bpy.ops.export_scene.gltf(filepath=f"{path}.glb")
        bpy.ops.wm.save_as_mainfile(filepath=f"{path}.blend", compress=False)
    return sorted(path for path in folder.glob("*.*") if path.suffix != ".mtl")


def damaged(source: Path, rng: random.Random) -> bytes:
    """Return the content of a file, damaged in one to four ways."""
    data = source.read_bytes()
    text = source.suffix in (".off", ".obj", ".ply", ".stl") and not source.stem.endswith("binary")
    for _ in range(rng.randint(1, 4)):
        if not data:
            break
        kind, at = rng.randrange(8), rng.randrange(len(data))
        if kind == 0:  # cut off
            data = data[:at]
        elif kind == 1:  # other bytes
            spoilt = bytearray(data)
            for _ in range(rng.choice([1, 1, 4, 30])):
                spoilt[rng.randrange(len(spoilt))] = rng.choice([0, 255, 127, 128, rng.randrange(256)])
            data = bytes(spoilt)
        elif kind == 2:  # more bytes
            data = data[:at] + rng.randbytes(rng.choice([1, 4, 100])) + data[at:]
        elif kind == 3:  # fewer
            data = data[:at] + data[at + rng.choice([1, 4, 100]) :]
        elif kind == 4 and not text:  # another number, in binary
            data = data[:at] + rng.choice(WORDS) + data[at + 4 :]
        else:
            data = with_other_lines(data, rng)
    return data


def with_other_lines(data: bytes, rng: random.Random) -> bytes:
    """Repeat or drop lines, or put another number into one; mostly near the head of the file."""
    lines = data.split(b"\n")
    row = rng.randrange(min(len(lines), rng.choice([6, 30, len(lines)])))
    kind = rng.randrange(3)
    if kind == 0:
        lines[row:row] = [lines[rng.randrange(len(lines))]] * rng.choice([1, 3])
    elif kind == 1:
        del lines[row : row + rng.choice([1, 1, 20])]
    else:
        words = lines[row].split(b" ")
        words[rng.randrange(len(words))] = rng.choice(NUMBERS).encode()
        lines[row] = b" ".join(words)
    return b"\n".join(lines)
