"""Drives a session in a window: takes its next step after the seconds that the last one asks for, then ends Blender."""

import os
import subprocess
import sys
import traceback

import bpy


def drive(steps, passed, pictures=None):
    """Take the steps of a session one by one; a failure is shown, in `pictures` as well, and ends Blender with 1."""

    def proceed():
        try:
            return next(steps)
        except StopIteration:
            print(passed, "in Blender", bpy.app.version_string, flush=True)
            sys.stdout.flush()
            os._exit(0)
        except BaseException:  # a test outside pytest: show whatever went wrong and stop Blender
            import faulthandler

            traceback.print_exc()
            faulthandler.dump_traceback()  # where the job's thread is
            if pictures is not None:
                subprocess.run(["import", "-window", "root", str(pictures / "failed.png")])
            sys.stderr.flush()
            os._exit(1)  # quit_blender would report success

    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(proceed, first_interval=3.0, persistent=True)
