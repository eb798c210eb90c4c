"""The experiments, in the order of the page."""

from importlib import import_module

from tools.benchmarks.experiment import REGISTERED

MODULES = ("forms", "cost", "ablation", "limbs", "heat", "pieces", "fused", "two_meshes", "comparison")

for module in MODULES:
    import_module(f"{__name__}.{module}")

EXPERIMENTS = dict(REGISTERED)
