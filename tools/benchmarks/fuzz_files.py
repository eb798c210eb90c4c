"""Runs the command line on damaged files for a given time: ``fuzz_files.py MINUTES KEEP [SEED]``.

Every file is a damaged copy of a small valid file, of each kind that can be read. Expected: exit code 0 or 1, no
traceback, no file that takes longer than a minute, nothing written outside the output folder. Files that fail are
kept in the folder KEEP.
"""

import collections
import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
BATCH, PATIENCE = 40, 60.0  # up to 500 pieces, each with its own form: a tenth of a second each
NUMBERS = ["-1", "0", "1", "255", "256", "65536", "2147483647", "2147483648", "-2147483649", "9" * 30, "1e400", "-1e39",
           "nan", "inf", "-inf", "1e-320", "abc", "", "0x10", "1.5", "½", "1/2/3", "//", "-0", "1e", "\0"]  # fmt: skip


def seeds(folder):
    """Write valid files of every kind: a tube, and a body of several pieces."""
    from tests.meshes import pieced, shapes

    body = pieced.character()[2]
    for name, (vertices, faces) in {"tube": shapes.joint(60, 14, 7), "body": (body.vertices, body.faces)}.items():
        write_every_kind(folder, name, vertices, faces)
    return sorted(path for path in folder.glob("*.*") if path.suffix != ".mtl")


def write_every_kind(folder, name, vertices, faces):
    """Write a mesh to files of every kind."""
    import bpy

    from tests.meshes import shapes

    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Mesh", mesh))
    bpy.ops.wm.obj_export(filepath=str(folder / f"{name}.obj"))
    bpy.ops.wm.ply_export(filepath=str(folder / f"{name}-text.ply"), ascii_format=True)
    bpy.ops.wm.ply_export(filepath=str(folder / f"{name}-binary.ply"), ascii_format=False)
    bpy.ops.wm.stl_export(filepath=str(folder / f"{name}-text.stl"), ascii_format=True)
    bpy.ops.wm.stl_export(filepath=str(folder / f"{name}-binary.stl"), ascii_format=False)
    bpy.ops.export_scene.gltf(filepath=str(folder / f"{name}.glb"))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"), compress=False)
    shapes.write_off(folder / f"{name}.off", vertices, faces)


def damaged(data, text, rng):
    """Damage a file in one to four ways."""
    for _ in range(rng.randint(1, 4)):
        kind = rng.randrange(8)
        if not data:
            return data
        at = rng.randrange(len(data))
        if kind == 0:
            data = data[:at]
        elif kind == 1:
            spoilt = bytearray(data)
            for _ in range(rng.choice([1, 1, 4, 30])):
                spoilt[rng.randrange(len(spoilt))] = rng.choice([0, 255, 127, 128, rng.randrange(256)])
            data = bytes(spoilt)
        elif kind == 2:
            data = data[:at] + rng.randbytes(rng.choice([1, 4, 100])) + data[at:]
        elif kind == 3:
            data = data[:at] + data[at + rng.choice([1, 4, 100]) :]
        elif kind == 4 and not text:
            word = rng.choice([b"\0\0\0\0", b"\xff" * 4, b"\x7f\xff\xff\xff", b"\0\0\0\x80"])
            data = data[:at] + word + data[at + 4 :]
        else:
            lines = data.split(b"\n")
            row = rng.randrange(min(len(lines), rng.choice([6, 30, len(lines)])))
            if kind == 5:
                lines[row:row] = [lines[rng.randrange(len(lines))]] * rng.choice([1, 3])
            elif kind == 6:
                del lines[row : row + rng.choice([1, 1, 20])]
            else:
                words = lines[row].split(b" ")
                words[rng.randrange(len(words))] = rng.choice(NUMBERS).encode()
                lines[row] = b" ".join(words)
            data = b"\n".join(lines)
    return data


def run(files, output):
    """Run the command line on files; return its exit code, errors, and the seconds between its lines."""
    words = [sys.executable, "-m", "addon", "compute", *map(str, files), "--output", str(output), "--quality", "draft",
             "--max-iterations", "5", "--landmark-count", "10", "--format", "obj"]  # fmt: skip
    errors = tempfile.TemporaryFile("w+", errors="replace")  # noqa: SIM115 - closed below
    process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, stderr=errors, text=True,
                               start_new_session=True)  # fmt: skip
    watch = subprocess.Popen(["sleep", str(PATIENCE * (len(files) + 2))])
    began, done, slowest = time.perf_counter(), [], 0.0
    assert process.stdout is not None
    for line in process.stdout:
        now = time.perf_counter()
        with contextlib.suppress(json.JSONDecodeError, KeyError):
            done.append(json.loads(line)["input"])
            slowest, began = max(slowest, now - began) if len(done) > 1 else slowest, now
        if watch.poll() is not None:
            break
    if watch.poll() is not None:
        os.killpg(process.pid, signal.SIGKILL)
        slowest = float("inf")
    code = process.wait()
    watch.kill()
    watch.wait()
    with errors:
        errors.seek(0)
        told = errors.read()
    return code, told, done, slowest


def main(minutes, keep, seed=0):
    rng, keep = random.Random(int(seed)), Path(keep)
    keep.mkdir(parents=True, exist_ok=True)
    count: collections.Counter[str] = collections.Counter()
    problems, answers = count.copy(), count.copy()
    until = time.monotonic() + 60 * float(minutes)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "seeds").mkdir()
        sound = seeds(work / "seeds")
        number = 0
        while time.monotonic() < until:
            box, output = work / "in", work / "out"
            shutil.rmtree(box, ignore_errors=True)
            shutil.rmtree(output, ignore_errors=True)
            box.mkdir()
            files = []
            for _ in range(BATCH):
                source = rng.choice(sound)
                number += 1
                text = source.suffix in (".off", ".obj", ".ply", ".stl") and not source.stem.endswith("binary")
                path = box / f"f{number}{source.suffix}"
                path.write_bytes(damaged(source.read_bytes(), text, rng))
                files.append(path)
                count[source.name] += 1
            left = files
            while left:
                code, told, done, slowest = run(left, output)
                names = [path for path in left if str(path) in done]
                for line in re.findall(r"canonical_form: \S+: (.*)", told):
                    answers[re.sub(r"f\d+|[-\d.e+]+", "#", line)[:90]] += 1
                if "Traceback" in told or slowest > PATIENCE:
                    kind = "slow" if slowest > PATIENCE else "traceback"
                    problems[kind] += 1
                    (keep / f"{kind}-{number}.txt").write_text(told)
                    for path in left:
                        shutil.copy(path, keep)
                if code in (0, 1):
                    break
                culprit = left[len(names)] if len(names) < len(left) else left[-1]
                problems[f"exit {code} {culprit.suffix}"] += 1
                shutil.copy(culprit, keep)
                (keep / f"{culprit.name}.txt").write_text(told[-3000:])
                left = left[left.index(culprit) + 1 :]
            strangers = set(work.iterdir()) - {box, output, work / "seeds"}
            if strangers or sorted(box.iterdir()) != sorted(files):
                problems["written elsewhere"] += 1
            print(f"{number} files, problems: {dict(problems)}", flush=True)
    print(dict(count))
    for answer, times in answers.most_common(40):
        print(times, answer)


if __name__ == "__main__":
    main(*sys.argv[1:])
