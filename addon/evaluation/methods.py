"""The methods that an evaluation compares: names, settings and sources."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

from ..core import InvalidSettingsError, Settings
from ..core.method_api.catalogue import methods
from ..core.method_api.registry import OURS

_TRUTH = {"true": True, "false": False}


@dataclass(frozen=True)
class Method:
    """A method, under its name in the tables.

    Attributes
    ----------
    name : str
        Name in tables, files and on the command line.
    settings : Settings or None
        Its settings; None for the unchanged mesh.
    source : str
        Its origin.
    """

    name: str
    settings: Settings | None
    source: str

    @property
    def rival(self) -> bool:
        """Whether it is a method of other authors."""
        return self.settings is not None and self.settings.method != OURS


def _known() -> dict[str, Method]:
    """Return all methods: ours and its variants, then the core's others, those with all pairs also at full quality."""
    found = [
        Method("input", None, "the mesh in its pose"),
        Method("ours", Settings(), "this project, default"),
        Method("ours-full", Settings(quality="full"), "this project, quality Full"),
        Method("ours-draft", Settings(quality="draft"), "this project, quality Draft"),
    ]
    for each in methods().values():
        if each.name == OURS:
            continue
        name, settings = each.name.replace("_", "-"), Settings(method=each.name)
        if each.pairs == "all":
            found.append(Method(name, settings, f"{each.source}, landmarks"))
            found.append(Method(f"{name}-full", replace(settings, quality="full"), f"{each.source}, all pairs"))
        else:
            found.append(Method(name, settings, each.source))
    return {method.name: method for method in found}


KNOWN = _known()
DEFAULT = tuple(
    name for name in KNOWN if name not in ("input", "ours-draft") and not name.endswith("-full")
)  # the fast ones
INPUT = "input"


def chosen_methods(words: list[str]) -> list[Method]:
    """Convert arguments of the command line to methods; the unchanged mesh always comes first.

    Parameters
    ----------
    words : list of str
        Names, optionally with settings: ``ours:quality=draft,landmark_count=50``.

    Returns
    -------
    list of Method
        The methods.

    Raises
    ------
    InvalidSettingsError
        If a name or setting is unknown.
    """
    chosen = {INPUT: KNOWN[INPUT]}
    for word in words:
        name, _, changes = word.partition(":")
        if name not in KNOWN:
            raise InvalidSettingsError(f"There is no method {name!r}. There are: {', '.join(KNOWN)}.")
        method = KNOWN[name]
        if changes and method.settings is not None:
            settings = replace(method.settings, **_changes(changes))
            safe = changes.replace("=", "-").replace(",", "-")
            method = Method(f"{name}-{safe}", settings, f"{method.source}, {changes}")
        chosen[method.name] = method
    return list(chosen.values())


def _changes(text: str) -> dict[str, Any]:
    known: dict[str, Any] = {each.name: each.default for each in fields(Settings)}
    changed: dict[str, Any] = {}
    for part in text.split(","):
        name, _, value = part.partition("=")
        default = known.get(name)
        if default is None or not value:
            raise InvalidSettingsError(f"{part!r} is not a setting with a value, such as quality=draft.")
        try:
            changed[name] = _TRUTH[value.lower()] if isinstance(default, bool) else type(default)(value)
        except (ValueError, KeyError) as error:
            raise InvalidSettingsError(f"{name} cannot be {value!r}.") from error
    return changed
