"""A hand on mouse and keyboard: simulated events in Blender's own window (it runs with ``--enable-event-simulate``)."""

import shutil
import subprocess

import bpy

UNIT = 20  # pixels of a button's height at a resolution scale of 1


class Hand:
    """Moves, clicks, drags and types; every method is a generator that yields the seconds to wait."""

    def __init__(self, pictures):
        self.pictures = pictures
        self.x = self.y = 0

    @property
    def window(self):
        return bpy.context.window_manager.windows[0]

    def area(self):
        return next(area for area in self.window.screen.areas if area.type == "VIEW_3D")

    def region(self, kind):
        return next(region for region in self.area().regions if region.type == kind)

    def event(self, kind, value, **options):
        self.window.event_simulate(kind, value, x=int(self.x), y=int(self.y), **options)

    def move(self, x, y):
        self.x, self.y = x, y
        self.event("MOUSEMOVE", "NOTHING")
        yield 0.02

    def click(self, x, y, button="LEFTMOUSE"):
        yield from self.move(x - 2, y)
        yield from self.move(x, y)
        self.event(button, "PRESS")
        yield 0.05
        self.event(button, "RELEASE")
        yield 0.02

    def drag(self, x, y, to_x, to_y, button="LEFTMOUSE"):
        yield from self.move(x, y)
        self.event(button, "PRESS")
        yield 0.02
        for step in range(1, 5):
            yield from self.move(x + (to_x - x) * step / 4, y + (to_y - y) * step / 4)
        self.event(button, "RELEASE")
        yield 0.05

    def key(self, name, **modifiers):
        letter = name.lower() if len(name) == 1 and not modifiers.get("ctrl") else ""
        self.event(name, "PRESS", **({"unicode": letter} if letter else {}), **modifiers)
        yield 0.05
        self.event(name, "RELEASE", **modifiers)
        yield 0.3

    def over_view(self):
        """Put the mouse into the middle of the view, where keys reach it."""
        region = self.region("WINDOW")
        yield from self.move(region.x + region.width * 0.35, region.y + region.height * 0.5)

    def close_message(self):
        """Close a message: it goes when the mouse is elsewhere, in Blender 5.2 with Esc, which stops jobs, too."""
        yield from self.over_view()
        yield from self.key("ESC")
        yield 0.5

    def below_top(self, pixels, share=0.5):
        """A place in the sidebar, measured from its top and across its width (without the tabs)."""
        region = self.region("UI")
        return region.x + share * (region.width - 1.2 * UNIT), region.y + region.height - pixels

    def click_until(self, happened, offsets, share=0.5, before=None, seconds=0.6):
        """Click down a column of the sidebar until something has happened, each time waiting so long for it."""
        for offset in offsets:
            if before is not None:
                before()
            yield from self.click(*self.below_top(offset, share))
            for _ in range(int(seconds / 0.02)):
                if happened():
                    return
                yield 0.02
        raise AssertionError(f"no click between {offsets[0]} and {offsets[-1]} below the top did it")

    def picture(self, name, at_once=False):
        for area in self.window.screen.areas:
            area.tag_redraw()
        yield 0.1 if at_once else 0.3
        if shutil.which("import"):
            command = ["import", "-window", "root", str(self.pictures / f"{name}.png")]
            if at_once:
                subprocess.Popen(command)
            else:
                subprocess.run(command, check=True)
