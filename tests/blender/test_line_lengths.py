"""Every text of the panels has room in a sidebar of the default width, in every language."""

from string import Formatter

import bpy
import pytest

from addon.blender.records.rig_record import RigRecord, write_rig
from addon.blender.words import wording
from addon.core.run.messages import message, sentences, sentences_of
from addon.interface import panels
from addon.interface.catalogues import catalogues
from addon.interface.job_operator import OBJECT_OT_canonical_form_cancel, Refusal
from addon.interface.sidebar import draw_sentence
from tests.blender.conftest import QUICK, Layout

WIDTH = 262  # pixels of a row of the panel, in the sidebar as Blender opens it, at a scale of 1
CHARACTER, ICON, PADDING = 6.2, 18, 8  # pixels: of a usual character, of an icon, beside a text
LANGUAGES = {"en": {}, **{name: {english: said for (_, english), said in words.items()} for name, words in
                          catalogues().items()}}  # fmt: skip


class Row(Layout):
    """A layout that adds up how wide what stands side by side is."""

    def __init__(self, side_by_side=False):
        super().__init__([])
        self.side_by_side, self.inside, self.columns = side_by_side, [], 1

    def _item(self, text, icon):
        self.inside.append((text, icon not in ("NONE", "")))

    def operator(self, name, text=None, icon="NONE", **_):
        self._item(bpy_label(name) if text is None else text, icon)
        return super().operator(name, text)

    def label(self, text="", icon="NONE", **_):
        self._item(text, icon)

    def progress(self, text="", **_):
        self._item(text, "NONE")

    def row(self, **_):
        inner = Row(side_by_side=True)
        self.inside.append(inner)
        return inner

    def column(self, **_):
        inner = Row()
        self.inside.append(inner)
        return inner

    box = column

    def grid_flow(self, columns=1, **_):
        inner = self.column()
        inner.columns = max(columns, 1)
        return inner

    def panel(self, name, **_):
        return self.row(), self.column()


def bpy_label(name):
    """What a button says that is given no text."""
    return wording.told(getattr(bpy.ops.object, name.partition(".")[2]).get_rna_type().name)


def is_icon(item):
    """Return whether an item of a row has no text."""
    return all(map(is_icon, item.inside)) if isinstance(item, Row) else not item[0]


def too_wide(row, room=WIDTH):
    """List the texts of a row without room; what stands side by side has equal shares, icons alone what they need."""
    found = []
    items = [each for each in row.inside if not isinstance(each, Row) or each.inside]
    alone = [each for each in items if is_icon(each)]
    left = room - (ICON + PADDING) * len(alone) if row.side_by_side else room
    count = max(len(items) - len(alone), 1) if row.side_by_side else row.columns
    for each in items:
        if is_icon(each):
            continue
        if isinstance(each, Row):
            found += too_wide(each, left / count)
        else:
            needed = CHARACTER * len(each[0]) + PADDING + ICON * each[1]
            if needed > left / count:
                found.append((each[0], round(needed), round(left / count)))
    return found


@pytest.fixture(params=sorted(LANGUAGES))
def language(request, monkeypatch):
    words = LANGUAGES[request.param]
    monkeypatch.setattr(wording, "_translated", lambda sentence: words.get(sentence, sentence))
    return request.param


@pytest.mark.parametrize("state", ["nothing", "form", "in-betweens", "by hand", "warned", "refused", "rigged"])
def test_every_text_has_room(figure_object, language, state, monkeypatch):
    from addon.blender.objects.body_points import fix_point
    from addon.blender.records.record import require_record, write_record

    if state != "nothing":
        bpy.ops.object.canonical_form(**QUICK)
    if state == "in-betweens":
        bpy.ops.object.canonical_form_in_betweens(count=2)
    if state == "by hand":
        for vertex in (3, 200, 400):
            fix_point([figure_object], figure_object, vertex, "")
    if state == "warned":
        record = require_record(figure_object.data)
        record.report.warnings = [wording.told(each) for each in sentences()]
        record.report.mends = dict(zip(record.report.warnings, ("PART", "LIMBS"), strict=False))
        write_record(figure_object.data, record)
    if state == "refused":
        refused = Refusal("Figure", "RIG", wording.told("This mesh has no faces."), "ANYWAY")
        monkeypatch.setattr(OBJECT_OT_canonical_form_cancel, "refused", refused)
    if state == "rigged":
        poses = {"Scan": "", "T-Pose": ""}
        write_rig(
            figure_object.data, RigRecord("", "", poses, "", "T", 0, [1.0, 2.0], {"toe.L": 0.1}, [], keys={"T": ""})
        )
    found = []
    for panel in panels.CLASSES:
        if issubclass(panel, bpy.types.Panel) and (not hasattr(panel, "poll") or panel.poll(bpy.context)):
            top = Row()
            panel.draw(type("Self", (), {"layout": top})(), bpy.context)
            found += too_wide(top)
    assert found == [], repr(found)


class Told(dict):
    """Values such as sentences have: a count of thousands, a short text, a share."""

    def __missing__(self, name):
        return type("Value", (), {"__format__": lambda _, kind: "12.3%" if "%" in kind else "8,220" if "," in kind else
                                  "Body" if name == "name" else "12"})()  # fmt: skip


# about arrays and options that the panel never gets wrong
IN_PYTHON_ONLY = {"face_shape", "feature_list", "feature_names", "file_damaged", "file_kind", "limb_mask",
                  "mannequin_arms", "match_no_side", "match_pose", "match_side", "options_type", "rest_shape",
                  "rig_pose", "source_list", "stance_arrays", "vertex_shape"}  # fmt: skip


def test_no_message_takes_more_than_two_lines(blender, language):
    left_out = {message for kind in IN_PYTHON_ONLY for message in sentences_of(kind)}
    for sentence in set(sentences()) - left_out:
        lines: list[str] = []
        words = wording.told(sentence)
        limit = wording.told_message(message("limit_free", limit=12.3, share=0.6))
        values = Told(limit=limit) if "{limit}" in words else Told()  # a phrase has the number itself
        filled = Formatter().vformat(words.replace("!r", ""), (), values)
        draw_sentence(Layout(lines), bpy.context, filled, "ERROR")
        assert "…" not in " ".join(lines), lines


def test_what_is_told_first_is_a_sentence(blender):
    lines: list[str] = []
    told = "1 face was left out. Mesh > Merge > By Distance removes such faces, and others that are like them."
    draw_sentence(Layout(lines), bpy.context, told)
    assert [line for line in lines if line] == ["1 face was left out."]


def test_what_is_cut_can_be_read(blender):
    lines: list[str] = []
    layout = Layout(lines)
    sentence = "A long sentence about many things that may be wrong with a mesh, and about what to do."
    draw_sentence(layout, bpy.context, sentence)
    assert lines[1].endswith(" …")
    kind = bpy.types.OBJECT_OT_canonical_form_read
    assert kind.description(bpy.context, type("Options", (), {"sentence": sentence})()) == sentence
    assert bpy.ops.object.canonical_form_read(sentence=sentence) == {"FINISHED"}
