"""Sentences in the language that Blender is shown in; English where a language has none for one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from ...core.run.messages import Message

if TYPE_CHECKING:
    from ...core.run.monitor import Progress

CONTEXT = "Canonical Form"  # what is ours among the words that Blender knows: its "Normal" is a direction
NAMED_STAGE = "{name}: {stage}"


def told(sentence: str, /, **values: Any) -> str:
    """Say a sentence in the language of Blender's interface.

    Parameters
    ----------
    sentence : str
        The English sentence, with a name in braces for each value: the catalogues of languages know it by this.
    **values
        What it tells.

    Returns
    -------
    str
        The sentence with its values.

    Examples
    --------
    >>> told("{name} has no faces.", name="Cube")
    'Cube has no faces.'
    """
    found = _translated(sentence)
    return found.format(**values) if values else found


def told_message(message: str) -> str:
    """Say a message of the core in the language of Blender's interface.

    Parameters
    ----------
    message : str
        A warning of the core, or the text of an error; one that is not the core's stays as it is.

    Returns
    -------
    str
        The sentence.
    """
    if not isinstance(message, Message) or not message.sentence:
        return str(message)
    values = {name: told_message(each) if isinstance(each, Message) else each for name, each in message.numbers.items()}
    return told(message.sentence, **values)


def named_stage(name: str, stage: str) -> Message:
    """Say of which object a stage of progress is.

    Parameters
    ----------
    name, stage : str
        Name of the object, and the stage in English.

    Returns
    -------
    Message
        Both; `told_stage` says it in the language of Blender's interface.

    Examples
    --------
    >>> print(named_stage("Cube", "Distances"))
    Cube: Distances
    """
    numbers = {"name": name, "stage": Message(stage, sentence=stage)}
    return Message(NAMED_STAGE.format(**numbers), numbers=numbers, sentence=NAMED_STAGE)


def progress_of(progress: Progress | None, name: str, number: int, count: int) -> Progress | None:
    """Report the progress of one of several objects as a share of that of all.

    Parameters
    ----------
    progress : callable or None
        Takes the share done of all, and the stage, which names the object where there are several.
    name : str
        Name of the object.
    number, count : int
        Which it is, from 0, and how many there are.

    Returns
    -------
    callable or None
        Takes the share done of the object, and the stage; None where nobody asks.

    Examples
    --------
    >>> progress_of(lambda done, stage: print(done, stage), "Cube", 1, 2)(0.5, "Distances")
    0.75 Cube: Distances
    """
    if progress is None:
        return None
    return lambda done, stage: progress((number + done) / count, stage if count == 1 else named_stage(name, stage))


def told_stage(stage: str) -> str:
    """Say a stage of progress in the language of Blender's interface.

    Parameters
    ----------
    stage : str
        The stage in English, or what `named_stage` made.

    Returns
    -------
    str
        The stage.
    """
    return told_message(stage) if isinstance(stage, Message) else told(stage)


def _translated(sentence: str) -> str:
    """Look a sentence up in the catalogue of the language."""
    found: str = bpy.app.translations.pgettext_iface(sentence, CONTEXT)
    return found
