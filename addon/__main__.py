"""Runs ``python -m addon`` where the bpy module is installed."""

import sys

if __name__ == "__main__":
    try:
        import bpy  # noqa: F401
    except ImportError:
        sys.exit("The command line needs Blender as a module. Install it with: pip install bpy")
    from .command_line import main

    sys.exit(main(sys.argv[1:]))
