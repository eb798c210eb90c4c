"""The session's step in other languages: Blender takes the catalogues that the extension brings."""

import importlib
import json
from pathlib import Path

import bpy

FILES = Path(__file__).resolve().parents[2] / "addon" / "languages"


def languages(hand):
    """Show the panel in every language, then in English again."""
    installed = "bl_ext.user_default.canonical_form.addon"
    told = importlib.import_module(f"{installed}.blender.words.wording").told
    in_english = importlib.import_module(f"{installed}.interface.commands").in_english
    view = bpy.context.preferences.view
    for path in sorted(FILES.glob("*.json")):
        view.language = path.stem
        view.use_translate_interface = view.use_translate_tooltips = True
        yield 1.5
        words = json.loads(path.read_text(encoding="utf-8"))
        for english, said in words["sentences"].items():
            found = bpy.app.translations.pgettext_iface(english, "Canonical Form")
            assert found == said, (path.stem, english, found)
        for english in words["tooltips"]:
            found = bpy.app.translations.pgettext_tip(english)
            assert found == words["sentences"][english], (path.stem, english, found)
        with in_english():
            assert told("Straighten") == "Straighten"
        assert told("Straighten") == words["sentences"]["Straighten"] != "Straighten"
        yield from hand.picture(f"language-{path.stem}")
    view.language = "en_US"
    yield 1.0
    assert bpy.app.translations.pgettext_iface("Straighten", "Canonical Form") == "Straighten"
