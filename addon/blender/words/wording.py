"""Text in the language of Blender's interface; English where the language has no translation."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import bpy

from ...core.run.messages import Message

if TYPE_CHECKING:
    from ...core.run.monitor import Progress

CONTEXT = "Canonical Form"  # translation context of our messages, apart from Blender's own: its "Normal" is a direction
NAMED_STAGE = "{name}: {stage}"
_FEW = 6  # names that a sentence lists at most


def told(sentence: str, /, **values: Any) -> str:
    """Translate a sentence into the language of Blender's interface.

    Parameters
    ----------
    sentence : str
        The English sentence, which is its key in the translation catalogues, with a name in braces for each value.
    **values
        Values to insert.

    Returns
    -------
    str
        The translated sentence with the values inserted.

    Examples
    --------
    >>> told("{name} has no faces.", name="Cube")
    'Cube has no faces.'
    """
    found = _translated(sentence)
    return found.format(**values) if values else found


def counted_points(count: int, patches: bool = False) -> str:
    """Say how many feature points were found.

    Parameters
    ----------
    count : int
        Number of feature points.
    patches : bool
        Whether each has a patch.

    Returns
    -------
    str
        The number with its noun.

    Examples
    --------
    >>> counted_points(1), counted_points(5, patches=True)
    ('1 feature point', '5 feature points and patches')
    """
    if patches:
        return (
            told("1 feature point and patch") if count == 1 else told("{count} feature points and patches", count=count)
        )
    return told("1 feature point") if count == 1 else told("{count} feature points", count=count)


def listed(names: Iterable[str]) -> str:
    """List names, the first ones if there are many.

    Parameters
    ----------
    names : iterable of str
        The names.

    Returns
    -------
    str
        The names, separated by commas.

    Examples
    --------
    >>> listed("ABC"), listed("ABCDEFGHIJ")
    ('A, B, C', 'A, B, C, D, E and 5 more')
    """
    every = list(names)
    if len(every) <= _FEW:
        return ", ".join(every)
    first = every[: _FEW - 1]
    return told("{names} and {count} more", names=", ".join(first), count=len(every) - len(first))


def told_message(message: str) -> str:
    """Translate a message of the core into the language of Blender's interface.

    Parameters
    ----------
    message : str
        A warning of the core, or the text of an error; text that is not a message of the core is returned unchanged.

    Returns
    -------
    str
        The translated message.
    """
    if not isinstance(message, Message) or not message.sentence:
        return str(message)
    values = {name: told_message(each) if isinstance(each, Message) else each for name, each in message.numbers.items()}
    return told(message.sentence, **values)


def named_stage(name: str, stage: str) -> Message:
    """Combine the name of an object with the current stage of its progress.

    Parameters
    ----------
    name, stage : str
        Name of the object, and the stage in English.

    Returns
    -------
    Message
        Both; `told_stage` translates it into the language of Blender's interface.

    Examples
    --------
    >>> print(named_stage("Cube", "Distances"))
    Cube: Distances
    """
    numbers = {"name": name, "stage": Message(stage, sentence=stage)}
    return Message(NAMED_STAGE.format(**numbers), numbers=numbers, sentence=NAMED_STAGE)


def progress_of(progress: Progress | None, name: str, number: int, count: int) -> Progress | None:
    """Convert the progress of one of several objects to progress over all of them.

    Parameters
    ----------
    progress : callable or None
        Takes the completed share of all objects, and the stage, prefixed with the object's name if there are several.
    name : str
        Name of the object.
    number, count : int
        Index of the object, from 0, and number of objects.

    Returns
    -------
    callable or None
        Takes the completed share of this object, and the stage; None if `progress` is None.

    Examples
    --------
    >>> progress_of(lambda done, stage: print(done, stage), "Cube", 1, 2)(0.5, "Distances")
    0.75 Cube: Distances
    """
    if progress is None:
        return None
    return lambda done, stage: progress((number + done) / count, stage if count == 1 else named_stage(name, stage))


def told_stage(stage: str) -> str:
    """Translate a stage of progress into the language of Blender's interface.

    Parameters
    ----------
    stage : str
        The stage in English, or a result of `named_stage`.

    Returns
    -------
    str
        The translated stage.
    """
    return told_message(stage) if isinstance(stage, Message) else told(stage)


def _translated(sentence: str) -> str:
    """Look up a sentence in the translation catalogue of the language."""
    found: str = bpy.app.translations.pgettext_iface(sentence, CONTEXT)
    return found
