"""Extracts the texts of the extension for translators, and packs their translations: `make translations`.

Writes the template tools/languages/canonical_form.pot, updates the .po files next to it (new texts are empty, obsolete
ones are dropped), and writes each as a .json file in addon/languages, which is registered with Blender. With
``--check`` it only checks whether everything is up to date and complete.
"""

from __future__ import annotations

import ast
import json
import os
import string
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import bpy  # noqa: E402
import polib  # noqa: E402

import addon  # noqa: E402
from addon.blender.transfer import transfer_item  # noqa: E402
from addon.blender.words import advice, wording  # noqa: E402
from addon.core.method_api.catalogue import methods  # noqa: E402
from addon.core.run.messages import sentences  # noqa: E402
from addon.interface import contact_operators, pose_operators, tool_operators  # noqa: E402

TEXTS = ROOT / "tools" / "languages"
PACKED = ROOT / "addon" / "languages"
DRAWN = {"text", "heading"}  # arguments of layout functions


def literals() -> Iterator[str]:
    """Yield the texts in the source: arguments of `told`, texts of layouts, and stages of progress."""
    for path in sorted(ROOT.glob("addon/**/*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            arguments = node.args[:1] if name in ("told", "stage") else []
            arguments += [each.value for each in node.keywords if each.arg in DRAWN and "interface" in path.parts]
            for each in arguments:
                if isinstance(each, ast.Constant) and isinstance(each.value, str):
                    yield each.value


def registered() -> Iterator[tuple[str, str]]:
    """Yield each label registered with Blender, with its tooltip; "" if there is none."""
    kinds = (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu, bpy.types.UIList, bpy.types.PropertyGroup,
             bpy.types.AddonPreferences)  # fmt: skip
    for kind in kinds:
        for each in sorted(kind.__subclasses__(), key=lambda found: found.__name__):
            if not each.__module__.startswith("addon.") or not getattr(each, "is_registered", False):
                continue
            tooltip = getattr(each, "bl_description", "") or each.__doc__ or "" if kind is bpy.types.Operator else ""
            yield getattr(each, "bl_label", ""), tooltip
            group, _, name = each.bl_idname.partition(".") if kind is bpy.types.Operator else ("", "", "")
            described = getattr(getattr(bpy.ops, group), name).get_rna_type() if name else each.bl_rna
            own_names = [name for name in described.properties.keys() if name not in described.base.properties]  # noqa: SIM118
            for known in (described.properties[name] for name in own_names):
                if known.is_hidden:
                    continue
                yield known.name, known.description
                for item in getattr(known, "enum_items_static", ()):
                    yield item.name, item.description


def messages() -> tuple[list[str], set[str]]:
    """Return all texts of the extension, without duplicates and in a stable order, and which of them are tooltips."""
    addon.register()
    pairs = [*registered()]
    addon.unregister()
    tooltips = {tooltip for _, tooltip in pairs} | {method.help for method in methods().values()}
    found = [*(each for pair in pairs for each in pair), *literals(), *sentences(), "Starting", wording.NAMED_STAGE]
    found += [*advice.ADVICE.values(), advice._NO_MEMORY, *transfer_item.CALLED.values()]
    found += [*pose_operators._DESCRIPTIONS.values(), *tool_operators._DESCRIPTIONS.values()]
    found += contact_operators._DESCRIPTIONS.values()
    for method in methods().values():
        found += [method.label, method.help]
    said = list(dict.fromkeys(each for each in found if any(letter.isalpha() for letter in each)))
    return said, tooltips


def places(sentence: str) -> set[tuple[str, str | None, str | None]]:
    """Return the placeholders of a text: each name in braces, with its format and conversion."""
    parts = string.Formatter().parse(sentence)
    return {(name, form, conversion) for _, name, form, conversion in parts if name is not None}


def brought_up_to_date(path: Path, found: list[str]) -> polib.POFile:
    """Read the translations of a language, in the order of the template."""
    old = {entry.msgid: entry.msgstr for entry in polib.pofile(str(path))} if path.exists() else {}
    made = polib.POFile(wrapwidth=120)
    made.metadata = {"Content-Type": "text/plain; charset=utf-8", "Language": path.stem}
    for sentence in found:
        made.append(polib.POEntry(msgid=sentence, msgstr=old.get(sentence, "")))
    return made


def packed(texts: polib.POFile, tooltips: set[str]) -> str:
    """Write the translations of a language in the format of the extension, and which of them are tooltips."""
    words = {entry.msgid: entry.msgstr for entry in texts if entry.msgstr}
    both = {"sentences": words, "tooltips": [english for english in words if english in tooltips]}
    return json.dumps(both, ensure_ascii=False, indent=0) + "\n"


def faults(texts: polib.POFile) -> list[str]:
    """Return what is missing in a language, or would fail when it is used."""
    missing = [f"no words for: {entry.msgid}" for entry in texts if not entry.msgstr]
    return missing + [f"other values in braces: {entry.msgid}" for entry in texts if entry.msgstr and not _fits(entry)]


def _fits(entry: polib.POEntry) -> bool:
    """Return whether a translation accepts the values of its text."""
    try:
        return places(entry.msgstr) == places(entry.msgid)
    except ValueError:  # an unmatched brace
        return False


def main(check: bool) -> int:
    (found, tooltips), wanted, told = messages(), {}, []
    for path in sorted(TEXTS.glob("*.po")):
        texts = brought_up_to_date(path, found)
        told += [f"{path.stem}: {fault}" for fault in faults(texts)]
        wanted[path] = f"{texts}\n"
        wanted[PACKED / f"{path.stem}.json"] = packed(texts, tooltips)
    wanted[TEXTS / "canonical_form.pot"] = f"{brought_up_to_date(Path(os.devnull) / 'template', found)}\n"
    if check:
        told += [f"{path.relative_to(ROOT)} is not current" for path, text in wanted.items()
                 if not path.exists() or path.read_text(encoding="utf-8") != text]  # fmt: skip
    else:
        for path, text in wanted.items():
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
    print(*told, sep="\n")
    print(f"{len(found)} sentences, {len(wanted) // 2} languages")
    return 1 if told else 0


if __name__ == "__main__":
    code = main("--check" in sys.argv)
    sys.stdout.flush()
    os._exit(code)  # Blender 4.2 as a module crashes on exit once a property with a callback was registered
