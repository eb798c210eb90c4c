"""The session's step in other languages: Blender takes the catalogues that the extension brings."""

import json
from pathlib import Path

import bpy

FILES = Path(__file__).resolve().parents[2] / "addon" / "languages"


def languages(hand):
    """Show the panel in every language, then in English again."""
    view = bpy.context.preferences.view
    for path in sorted(FILES.glob("*.json")):
        view.language = path.stem
        view.use_translate_interface = view.use_translate_tooltips = True
        yield 1.5
        for english, said in json.loads(path.read_text(encoding="utf-8")).items():
            found = bpy.app.translations.pgettext_iface(english, "Canonical Form")
            assert found == said, (path.stem, english, found)
        yield from hand.picture(f"language-{path.stem}")
    view.language = "en_US"
    yield 1.0
    assert bpy.app.translations.pgettext_iface("Compute", "Canonical Form") == "Compute"
