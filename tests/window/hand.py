"""A hand on mouse and keyboard: simulated events in Blender's own window (it runs with ``--enable-event-simulate``)."""

import shutil
import subprocess

import bpy

UNIT = 20  # pixels of a button's height at a resolution scale of 1
POSE, FORM = "canonical_form_pose_like(", "object.canonical_form("
WISHES = {  # what Blender copies from their buttons
    "T": (POSE, "pose='T'"),
    "A": (POSE, "pose='A'"),
    "like": (POSE, "pose='OBJECT'"),
    "rig": ("canonical_form_rig(",),
    "straighten": (FORM,),
    "live": ("canonical_form_live(",),
    "limbs": (FORM, "step='FEATURES'"),
}
NOT_WISHES = {"straighten": "step='FEATURES'"}


class Hand:
    """Moves, clicks, drags and types; every method is a generator that yields the seconds to wait."""

    def __init__(self, pictures):
        self.pictures = pictures
        self.known = {}  # places of buttons that were found
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

    def told_by(self, below, share):
        """What the button at a place of the sidebar is: the command of an operator, or the path of a value."""
        manager = bpy.context.window_manager
        manager.clipboard = ""
        yield from self.move(*self.below_top(below, share))
        yield 0.02
        with bpy.context.temp_override(window=self.window, area=self.area(), region=self.region("UI")):
            if bpy.ops.ui.copy_python_command_button.poll():
                bpy.ops.ui.copy_python_command_button()
            elif bpy.ops.ui.copy_data_path_button.poll():
                bpy.ops.ui.copy_data_path_button(full_path=True)
        return manager.clipboard

    def find(self, what, *parts, without="\0", first=30, last=None, shares=(0.3, 0.8, 0.93)):
        """Find a button of the sidebar by what Blender copies from it: gives (below, share), or None.

        Looks first where it was the last time.
        """
        last = self.region("UI").height - 10 if last is None else last
        known = self.known.get((what, parts))
        places = [known] if known is not None else []
        places += [(below, share) for share in shares for below in range(first, last, 9)]
        for below, share in places:
            told = yield from self.told_by(below, share)
            if what in told and all(part in told for part in parts) and without not in told:
                self.known[what, parts] = below, share
                return below, share
        return None

    def press(self, what, *parts, happened=None, seconds=1.5, **where):
        """Click on a button, and wait until something has happened."""
        at = yield from self.find(what, *parts, **where)
        assert at is not None, f"no button of the sidebar is {what} {parts}"
        yield from self.click(*self.below_top(*at))
        for _ in range(int(seconds / 0.02) if happened is not None else 0):
            if happened():
                break
            yield 0.02
        assert happened is None or happened(), f"a click on {what} {parts} does nothing"
        yield 0.1

    def scroll(self, turns):
        """Turn the wheel over the sidebar, down if above 0."""
        yield from self.move(*self.below_top(60))
        for _ in range(abs(turns)):
            self.event("WHEELDOWNMOUSE" if turns > 0 else "WHEELUPMOUSE", "PRESS")
            yield 0.05
        yield 0.5

    def press_wish(self, wish, running, seconds=1.5):
        """Click on a wish until its job runs."""
        yield from self.over_view()
        yield from self.press(*WISHES[wish], happened=running, seconds=seconds, without=NOT_WISHES.get(wish, "\0"))

    def row_above(self):
        """Where the last row of the wishes is, below the top: panels follow it."""
        at = yield from self.find("canonical_form.like")
        return at[0]

    def fold(self, header, what, *parts):
        """Close a panel that `unfold` has opened for a button."""
        for _ in range(3):
            yield from self.over_view()
            self.region("UI").tag_redraw()
            yield 0.5
            row = yield from self.row_above()
            at = yield from self.find(what, *parts, first=row + header, last=row + header + 330, shares=(0.6,))
            if at is None:
                return
            yield from self.click(*self.below_top(row + header, 0.2))
            yield 0.7
        raise AssertionError(f"the panel of {what} does not close")

    def unfold(self, what, *parts, below):
        """Open panels until a button is there, from some pixels below the wishes: gives where its header is below them.

        A header is clicked again if the button is not in its panel.
        """
        row = yield from self.row_above()
        at = yield from self.find(what, *parts, first=row + below, shares=(0.6,))
        assert at is None, "the panel is open"
        tried = row + below
        while at is None:
            assert tried < row + below + 160, f"no panel below {below} has {what}"
            yield from self.click(*self.below_top(tried, 0.2))
            yield 0.4
            at = yield from self.find(what, *parts, first=tried, last=tried + 330, shares=(0.6,))
            if at is None:
                yield from self.click(*self.below_top(tried, 0.2))
                yield 0.4
                tried += 13
        return tried - row

    def picture(self, name, at_once=False, redrawn=True):
        for area in self.window.screen.areas if redrawn else ():
            area.tag_redraw()
        yield 0.1 if at_once else 0.3
        if shutil.which("import"):
            command = ["import", "-window", "root", str(self.pictures / f"{name}.png")]
            if at_once:
                subprocess.Popen(command)
            else:
                subprocess.run(command, check=True)
