"""Everything that the extension says can be said in another language, and is in those that it brings."""

import re
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from addon.blender.words import wording
from addon.blender.words.advice import advised, explained
from addon.core import CanonicalFormError, InvalidMeshError, canonical_form
from addon.core.run.errors import TooLargeError
from addon.core.run.messages import message
from addon.interface import menus, panels
from addon.interface.catalogues import LANGUAGES, catalogues
from tests.blender.conftest import QUICK, Layout, drawn

ROOT = Path(__file__).resolve().parents[2]
DATA = re.compile(r"^(Patch \d+  \([\d,]+\)|Basis|Figure|\[\".*|[a-z_]+|object\.\w+|Pose)?$")  # names, not sentences


@pytest.fixture
def another_language(monkeypatch):
    """A language in which every sentence stands in brackets."""
    monkeypatch.setattr(wording, "_translated", lambda sentence: f"⟦{sentence}⟧")


def test_the_catalogues_are_current_and_complete():
    done = subprocess.run(
        [sys.executable, "tools/translations.py", "--check"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_blender_is_handed_every_language():
    found = catalogues()
    assert sorted(found) == [path.stem for path in sorted(LANGUAGES.glob("*.json"))]
    assert {"de_DE", "fr_FR"} <= set(found)
    for words in found.values():
        assert words["Canonical Form", "Straighten"] != "Straighten"


def test_only_tooltips_are_known_without_our_context():
    """A label known there would translate that of every other extension."""
    for words in catalogues().values():
        tooltips = {english for context, english in words if context == "*"}
        assert "Mesh that the form is computed from" in tooltips
        assert tooltips.isdisjoint({"Straighten", "Weights", "Keys", "Clear", "Materials", "Patch", "Value", "Mesh"})
        labels = [each.bl_label for kind in (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu)
                  for each in kind.__subclasses__() if each.__module__.startswith("addon.")]  # fmt: skip
        assert labels
        assert tooltips.isdisjoint(labels)


def test_sentences_keep_their_values_in_every_language():
    for words in catalogues().values():
        for (context, english), said in words.items():
            if context == wording.CONTEXT:
                assert sorted(re.findall(r"\{[^}]*\}", said)) == sorted(re.findall(r"\{[^}]*\}", english)), english


@pytest.mark.parametrize("state", ["nothing", "form", "limb", "in-betweens", "features"])
def test_every_text_of_the_panels_can_be_translated(figure_object, monkeypatch, state):
    marked = lambda sentence: " ".join(f"⟦{word}" for word in sentence.split(" "))  # noqa: E731 (long ones are wrapped)
    monkeypatch.setattr(wording, "_translated", marked)
    known = {english for _, english in catalogues()["de_DE"]}
    if state != "nothing":
        bpy.ops.object.canonical_form(step="FEATURES" if state == "features" else "FORM", **QUICK)
    if state == "limb":
        bpy.ops.object.canonical_form_limb(patch=1, only=True)
    if state == "in-betweens":
        bpy.ops.object.canonical_form_in_betweens(count=2)
    chosen = bpy.context.object.canonical_form
    chosen.method = "classical"
    for panel in panels.CLASSES:
        if issubclass(panel, bpy.types.Panel):
            for text in drawn(panel):
                assert "⟦" in text or text in known or DATA.match(text), text


def test_messages_of_the_core_are_translated(another_language):
    assert advised(message("no_faces")) == "⟦The mesh has no faces. Choose a mesh with a surface.⟧"
    told = advised(message("loose_vertices", count=3))
    advice = "Mesh > Clean Up > Delete Loose removes such vertices."
    assert told == f"⟦3 vertices that belong to no face stay where they are.⟧ ⟦{advice}⟧"
    with pytest.raises(CanonicalFormError) as caught:
        canonical_form([[0.0, 0, 0]], [])
    assert explained(caught.value).startswith("⟦")
    assert explained(MemoryError()).startswith("⟦Not enough memory.")
    error = TooLargeError("mesh_memory", vertices=10, needed=3.0, limit=message("limit_given", limit=2.0))
    assert "⟦the limit of 2 GB⟧" in explained(error)


def test_many_names_are_told_in_part(another_language):
    assert wording.listed([]) == ""
    assert wording.listed(iter("ABCDEF")) == "A, B, C, D, E, F"
    assert wording.listed("ABCDEFG") == "⟦A, B, C, D, E and 2 more⟧"


def test_stages_of_several_objects_and_errors_of_the_other_mesh_are_translated(another_language):
    assert wording.told_stage("Distances") == "⟦Distances⟧"
    stage = wording.named_stage("Cube {0}", "Distances")
    assert stage == "Cube {0}: Distances"
    assert wording.told_stage(stage) == "⟦Cube {0}: ⟦Distances⟧⟧"
    error = InvalidMeshError("not_finite", count=3).about(message("other_mesh"))
    assert (error.kind, error.numbers["count"]) == ("not_finite", 3)
    assert explained(error).startswith("⟦⟦The other mesh⟧: ⟦3 vertices have coordinates")


def test_a_name_with_braces_is_no_place_for_a_value(figure_object):
    figure_object.data.name = "{0} {x}"
    figure_object.data.clear_geometry()
    with pytest.raises(RuntimeError, match=r"\{0\} \{x\} has no faces"):
        bpy.ops.object.canonical_form()


class MenuLayout(Layout):
    """A layout that also lists which operators a menu offers, with those of the menus in it."""

    def __init__(self, lines, offered):
        super().__init__(lines)
        self.offered = offered

    def operator(self, name, text=None, **_):
        self.offered.append(name)
        return super().operator(name, text)

    def operator_menu_enum(self, name, enum, text=None, **_):
        assert enum in getattr(bpy.ops.object, name.partition(".")[2]).get_rna_type().properties
        self.operator(name, text)

    def separator(self, **_):
        pass

    def menu(self, name, **_):
        getattr(bpy.types, name).draw(type("Self", (), {"layout": self})(), bpy.context)


def test_every_option_is_translated_as_ours(blender):
    operators = [name for name in dir(bpy.ops.object) if name.startswith("canonical_form")]
    kinds = [getattr(bpy.ops.object, name).get_rna_type() for name in operators]
    kinds.append(bpy.types.Object.bl_rna.properties["canonical_form"].fixed_type)
    options = [each for kind in kinds for each in kind.properties if each.identifier not in ("rna_type", "name")]
    assert len(options) > 50
    assert [each.identifier for each in options if each.translation_context != wording.CONTEXT] == []


@pytest.mark.parametrize("formed", [False, True])
def test_every_action_is_in_a_menu_where_the_search_finds_it(figure_object, formed):
    if formed:
        bpy.ops.object.canonical_form(**QUICK)
    offered: list[str] = []
    texts: list[str] = []
    menus.draw_actions(type("Self", (), {"layout": MenuLayout(texts, offered)})(), bpy.context)
    ours = {each.bl_idname for each in bpy.types.Operator.__subclasses__()
            if each.__module__.startswith("addon.") and getattr(each, "is_registered", False)}  # fmt: skip
    of_the_panel = {"object.canonical_form_cancel", "object.canonical_form_read"}  # while it runs; beside a sentence
    missing = ours - set(offered) - of_the_panel
    assert missing == (set() if formed else {"object.canonical_form_select_patch"})
    assert ("Only Patch 1" in texts) == formed
