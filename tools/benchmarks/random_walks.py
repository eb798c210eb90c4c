"""Runs long random walks in Blender and measures the memory: ``random_walks.py [WALKS] [STEPS] [FIRST SEED]``."""

import sys
import time
from collections import Counter
from pathlib import Path

import bpy
import psutil

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import addon
from tests.blender.walks import Walk
from tests.meshes import shapes


def main(walks=20, steps=500, first=0):
    arrays, memory = shapes.figure(12), []
    done: Counter[str] = Counter()
    for seed in range(first, first + walks):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.preferences.filepaths.save_version = 0
        addon.register()
        began, walk = time.perf_counter(), Walk("addon", arrays, seed)
        try:
            walk.run(steps)
        except BaseException:
            print(f"walk {seed}, step {len(walk.steps)}: {walk.steps[-10:]}", flush=True)
            raise
        addon.unregister()
        done.update(walk.counts)
        memory.append(psutil.Process().memory_info().rss / 1e6)
        print(f"walk {seed}: {steps} steps in {time.perf_counter() - began:.0f} s, {memory[-1]:.0f} MB", flush=True)
    print(dict(done))
    if walks > 2:
        print(f"memory after the last walk over that after the second: {memory[-1] / memory[1]:.3f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
