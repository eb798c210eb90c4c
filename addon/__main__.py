"""Runs ``python -m addon`` where the bpy module is installed."""

import sys

from .result_lines import claim_output

if __name__ == "__main__":
    claimed = claim_output()  # before bpy is imported: it has something to say too
    try:
        import bpy  # noqa: F401
    except ImportError:
        sys.exit("The command line needs Blender as a module. Install it with: pip install bpy")
    from .command_line import main

    sys.exit(main(sys.argv[1:], claimed))
