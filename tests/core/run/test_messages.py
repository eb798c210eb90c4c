"""Messages: every kind is used and known, tells its numbers, and names no menu of any program."""

import ast
import pickle
import re
from pathlib import Path
from string import Formatter

import pytest

from addon.core import CanonicalFormError, InvalidMeshError
from addon.core.run import errors, messages
from addon.core.run.messages import Message, kinds, message

CORE = Path(messages.__file__).resolve().parents[1]
SENTENCES = {**messages._SENTENCES, **messages._PHRASES}
ERRORS = {
    name for name, each in vars(errors).items() if isinstance(each, type) and issubclass(each, CanonicalFormError)
}


def texts_of(kind):
    """The sentence of a kind, or both."""
    sentence = SENTENCES[kind]
    return sentence if isinstance(sentence, tuple) else (sentence,)


def numbers_of(kind):
    """Names of the numbers that a kind tells."""
    found = {name.split(".")[0] for text in texts_of(kind) for _, name, _, _ in Formatter().parse(text) if name}
    return found | ({"count"} if isinstance(SENTENCES[kind], tuple) else set())


def uses():
    """Every kind that the core tells: file and line, kind, and names of the numbers."""
    for path in sorted(CORE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        named = {kind for call in calls_in(tree) for kind in direct(call)}
        kept = {each.value for each in ast.walk(tree) if isinstance(each, ast.Constant)} & set(SENTENCES) - named
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef):
                handed_on = {each.arg for each in [*function.args.posonlyargs, *function.args.args]}
                for call in calls_in(function):
                    where, given = f"{path.relative_to(CORE)}:{call.lineno}", {each.arg for each in call.keywords}
                    found = direct(call)
                    if not found and ast.unparse(call.args[0]) not in handed_on:
                        assert kept, f"{where} names no kind, and there is none in its file"
                        found = kept
                    for kind in found:
                        yield where, kind, given


def calls_in(tree):
    """Calls that make a message, warn of one, or make an error of the core."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call) and tells(node)]


def tells(node: ast.Call):
    if isinstance(node.func, ast.Name):
        return node.func.id == "message" or node.func.id in ERRORS
    return (
        isinstance(node.func, ast.Attribute) and node.func.attr == "warn" and ast.unparse(node.func) != "warnings.warn"
    )


def direct(call):
    """The kind that a call names, if it is no variable."""
    if not call.args:
        return {"cancelled"} if ast.unparse(call.func) == "CancelledError" else {"none"}
    return {call.args[0].value} if isinstance(call.args[0], ast.Constant) else set()


def test_every_kind_that_is_used_exists_and_gets_its_numbers():
    for where, kind, given in uses():
        assert kind in SENTENCES, where
        assert given == numbers_of(kind), where


def test_every_kind_is_used():
    assert sorted(set(SENTENCES) - {kind for _, kind, _ in uses()}) == []


@pytest.mark.parametrize("kind", kinds())
def test_sentences_name_no_menu_and_are_sentences(kind):
    for text in texts_of(kind):
        assert " > " not in text
        assert not re.search(r"\b(Blender|Edit Mode|Object Mode|Ctrl|Alt|panel|menu|button)\b", text)
        assert text.endswith(".")
        assert text[0].isupper() or text.startswith(("{", "1 ", *numbers_like_names()))


def numbers_like_names():
    """Options and arguments that open a sentence as they are spelt in code."""
    return ("method ", "kind ", "feature_points ", "feature_names ", "chosen ", "ways ")


def filled(kind):
    return dict.fromkeys(numbers_of(kind), 2)


@pytest.mark.parametrize("kind", kinds())
def test_a_message_knows_its_kind_and_numbers(kind):
    told = message(kind, **filled(kind))
    assert isinstance(told, str)
    assert told.kind == kind
    assert told.numbers == filled(kind)
    assert "{" not in told
    for name in numbers_of(kind) - {"count"}:
        without = {other: 2 for other in numbers_of(kind) if other != name}
        with pytest.raises(KeyError):
            message(kind, **without)


def test_one_of_something_is_told_in_the_singular():
    assert message("repeated_corners", count=1).startswith("1 face was")
    assert message("repeated_corners", count=1200).startswith("1,200 faces were")


def test_an_unknown_kind_is_refused():
    with pytest.raises(KeyError):
        message("no_such_kind")


@pytest.mark.parametrize("told", [("face_range", 7), (message("face_range", last=7), None)])
def test_errors_carry_the_kind_and_the_numbers(told):
    error = InvalidMeshError(told[0], **({} if told[1] is None else {"last": told[1]}))
    told = (error.kind, error.numbers, str(error))
    assert told == ("face_range", {"last": 7}, "Faces refer to vertices outside 0 to 7.")
    for bare in (CanonicalFormError("anything"), CanonicalFormError()):
        assert (bare.kind, bare.numbers) == ("", {})
    assert (Message("anything").kind, Message("anything").numbers) == ("", {})


def test_messages_and_errors_survive_the_way_between_processes():
    told = pickle.loads(pickle.dumps(message("face_range", last=7)))
    assert (told, told.kind, told.numbers) == ("Faces refer to vertices outside 0 to 7.", "face_range", {"last": 7})
    error = pickle.loads(pickle.dumps(InvalidMeshError(told)))
    assert (error.kind, error.numbers) == ("face_range", {"last": 7})
