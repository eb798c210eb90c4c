"""A window for a trial by someone who has not seen it: `run.py --session tests/window/trial.py --character FILE`.

Run by Blender itself, as `session.py` is. The tester sees pictures and has mouse and keyboard, no Python: every file
`NAME.do` in the folder of the pictures is taken, done line by line, and answered by `NAME.png`, a picture of the
window. Places are pixels of the picture, from its top left corner::

    click X Y [left|middle|right] [shift] [ctrl] [alt] [double]
    drag X Y X2 Y2 [left|middle|right] [shift] [ctrl] [alt]
    hover X Y            wheel X Y TURNS (down if above 0)
    key NAME [shift] [ctrl] [alt]            type TEXT            wait SECONDS            end
"""

import sys
from pathlib import Path

import bpy

PACKAGE, PICTURES, *FILES = (Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :])
sys.path[:0] = [str(Path(__file__).resolve().parents[2])]

from tests.window.driving import drive  # noqa: E402
from tests.window.hand import Hand  # noqa: E402
from tests.window.opening import import_file  # noqa: E402

BUTTONS = {"left": "LEFTMOUSE", "middle": "MIDDLEMOUSE", "right": "RIGHTMOUSE"}
MODIFIERS = ("shift", "ctrl", "alt")
TOOLTIP = 1.6  # seconds of rest until Blender shows a tooltip
hand = Hand(PICTURES)


def session():
    """Open the file with the extension installed and the sidebar closed, then do what is asked."""
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"  # a window of its own would not be reached
    bpy.ops.extensions.package_install_files(
        filepath=str(PACKAGE), repo="user_default", enable_on_install=True, overwrite=True
    )
    bpy.data.batch_remove([*bpy.data.objects])
    for path in FILES:
        import_file(path)
    with bpy.context.temp_override(window=hand.window, area=hand.area(), region=hand.region("WINDOW")):
        bpy.ops.view3d.view_all()
    bpy.ops.ed.undo_push(message="Import")
    yield 1.0
    yield from hand.picture("start")
    while True:
        asked = sorted(PICTURES.glob("*.do"))
        if not asked:
            yield 0.1
            continue
        lines = asked[0].read_text().splitlines()
        asked[0].unlink()
        for line in filter(str.strip, lines):
            if line.strip() == "end":
                return
            try:
                yield from done(*line.split())
            except (ValueError, TypeError, KeyError, RuntimeError) as error:
                print(f"not understood: {line}: {error}", flush=True)
        rests = bool(lines) and lines[-1].startswith("hover")  # a redraw would take the tooltip away
        yield from hand.picture(f"{asked[0].stem}-taken", redrawn=not rests)
        (PICTURES / f"{asked[0].stem}-taken.png").replace(PICTURES / f"{asked[0].stem}.png")  # seen whole or not at all


def done(verb, *words):
    """Do what one line asks for."""
    held = {word: True for word in words if word in MODIFIERS}
    button = next((BUTTONS[word] for word in words if word in BUTTONS), "LEFTMOUSE")
    if verb == "wait":
        yield float(words[0])
    elif verb == "key":
        yield from hand.key(words[0].upper(), **held)
    elif verb == "type":
        for letter in " ".join(words):
            hand.event("A", "PRESS", unicode=letter)
            yield 0.03
            hand.event("A", "RELEASE")
    elif verb == "wheel":
        yield from hand.move(*place(words))
        for _ in range(abs(int(words[2]))):
            hand.event("WHEELDOWNMOUSE" if int(words[2]) > 0 else "WHEELUPMOUSE", "PRESS")
            yield 0.05
    elif verb in {"click", "hover", "drag"}:
        yield from hand.move(*place(words))
        yield 0.05
        yield from hand.move(hand.x + 1, hand.y)  # Blender takes a place from the second event there
        if verb == "hover":
            yield TOOLTIP
            return
        hand.event(button, "PRESS", **held)
        yield 0.05
        if verb == "drag":
            begin, end = (hand.x, hand.y), place(words[2:])
            for step in range(1, 9):
                yield from hand.move(*(a + (b - a) * step / 8 for a, b in zip(begin, end, strict=True)))
        hand.event(button, "RELEASE", **held)
        if "double" in words:
            yield 0.05
            hand.event(button, "PRESS", **held)  # Blender tells that it is the second
            yield 0.05
            hand.event(button, "RELEASE")
        yield 0.2
    else:
        raise ValueError(f"there is no {verb}")


def place(words):
    """A place in the window, which counts from below."""
    return float(words[0]), hand.window.height - float(words[1])


drive(session(), "TRIAL ENDED", PICTURES)
