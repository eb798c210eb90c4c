"""Runs ``python -m addon`` where the bpy module is installed."""

import sys

from .result_lines import own_output

if __name__ == "__main__":
    with own_output() as output:  # before bpy is imported: it has something to say too
        try:
            import bpy  # noqa: F401
        except ImportError:
            sys.exit("The command line needs Blender as a module. Install it with: pip install bpy")
        from .command_line import main

        code = main(sys.argv[1:], output)
    sys.exit(code)
