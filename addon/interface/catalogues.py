"""The languages that the extension speaks beside English, handed to Blender."""

from __future__ import annotations

import json
from pathlib import Path

import bpy

from ..blender.words.wording import CONTEXT
from .preferences import PACKAGE

LANGUAGES = Path(__file__).parents[1] / "languages"  # a file for each, named after Blender's name for it
_NO_CONTEXT = "*"  # where Blender looks for tooltips; labels there would translate those of other extensions, too


def catalogues() -> dict[str, dict[tuple[str, str], str]]:
    """Read the sentences of every language.

    Returns
    -------
    dict
        By language, the words for each English sentence in each of Blender's contexts.

    Examples
    --------
    >>> catalogues()["de_DE"]["Canonical Form", "Compute"]
    'Berechnen'
    """
    found = {}
    for path in sorted(LANGUAGES.glob("*.json")):
        words = json.loads(path.read_text(encoding="utf-8"))
        found[path.stem] = {(CONTEXT, english): said for english, said in words["sentences"].items()}
        found[path.stem] |= {(_NO_CONTEXT, english): words["sentences"][english] for english in words["tooltips"]}
    return found


def register() -> None:
    """Hand the languages to Blender."""
    bpy.app.translations.register(PACKAGE, catalogues())


def unregister() -> None:
    """Take them back."""
    bpy.app.translations.unregister(PACKAGE)
