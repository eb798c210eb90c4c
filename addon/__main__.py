"""Runs ``python -m addon``: `compute` where the bpy module is installed, `evaluate` anywhere."""

import sys

from .result_lines import claim_output
from .supervision import done_before, is_supervised, supervised

if __name__ == "__main__":
    if sys.argv[1:2] == ["evaluate"]:
        from .evaluation.command import main as evaluate

        sys.exit(evaluate(sys.argv[2:]))
    if not is_supervised():
        sys.exit(supervised(sys.argv[1:]))
    done = done_before()
    claimed = claim_output()  # before bpy is imported: it has something to say too
    try:
        import bpy  # noqa: F401
    except ImportError:
        sys.exit("The command line needs Blender as a module. Install it with: pip install bpy")
    from .command_line import main

    sys.exit(main(sys.argv[1:], claimed, done))
