"""Translations of the extension, registered with Blender."""

from __future__ import annotations

import json
from pathlib import Path

import bpy

from ..blender.words.wording import CONTEXT
from .preferences import PACKAGE

LANGUAGES = Path(__file__).parents[1] / "languages"  # one file per language, named after Blender's name of the language
_NO_CONTEXT = "*"  # context of tooltips in Blender; labels in it would also translate those of other extensions


def catalogues() -> dict[str, dict[tuple[str, str], str]]:
    """Read the translations of all languages.

    Returns
    -------
    dict
        By language, the translation of each English sentence in each of Blender's translation contexts.

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
    """Register the translations with Blender."""
    bpy.app.translations.register(PACKAGE, catalogues())


def unregister() -> None:
    """Unregister the translations."""
    bpy.app.translations.unregister(PACKAGE)
