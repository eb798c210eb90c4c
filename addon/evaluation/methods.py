"""The methods that an evaluation compares: names, settings and where they come from."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

from ..core import InvalidSettingsError, Settings
from ..core.unfolding.settings import METHODS as CORE_METHODS

_PATIENT = 1e-5  # tolerance of the rivals, which need more steps to settle than the method of this project
_TRUTH = {"true": True, "false": False}
RECOGNITION = ("Coarse mesh", "Triangulation", "Spectrum", "Feature points", "Patches")  # stages no rival needs


@dataclass(frozen=True)
class Method:
    """A method under the name it has in the tables.

    Attributes
    ----------
    name : str
        Name in tables, files and on the command line.
    settings : Settings or None
        Its settings; None for the mesh as it is.
    source : str
        Where it comes from.
    """

    name: str
    settings: Settings | None
    source: str

    @property
    def rival(self) -> bool:
        """Whether it is another's method."""
        return self.settings is not None and self.settings.method != CORE_METHODS[0]


def _rival(name: str, method: str, source: str, quality: str = "normal") -> Method:
    return Method(name, Settings(method=method, quality=quality, tolerance=_PATIENT), source)


_ELAD = "Elad and Kimmel 2003"
_PICKUP = "Pickup, Sun, Rosin and Martin 2015"
_ALL = [
    Method("input", None, "the mesh in its pose"),
    Method("ours", Settings(), "this project, default"),
    Method("ours-unbent", Settings(unbending=3.0, tolerance=1e-5), "this project, unbending 3"),
    Method("ours-full", Settings(quality="full"), "this project, quality Full"),
    Method("ours-draft", Settings(quality="draft"), "this project, quality Draft"),
    Method("ours-published", Settings(as_published=True), "the paper to the letter"),
    _rival("classical", "classical", f"{_ELAD}, landmarks"),
    _rival("classical-full", "classical", f"{_ELAD}, all pairs", "full"),
    _rival("least-squares", "least_squares", f"{_ELAD}, landmarks"),
    _rival("least-squares-full", "least_squares", f"{_ELAD}, all pairs", "full"),
    _rival("non-metric", "non_metric", "Kruskal 1964, landmarks"),
    _rival("non-metric-full", "non_metric", "Kruskal 1964, all pairs", "full"),
    _rival("fast", "fast", "FastMap, Faloutsos and Lin 1995"),
    _rival("euclidean-random", "euclidean_random", f"{_PICKUP}, random pairs"),
    _rival("euclidean-normalised", "euclidean_normalised", f"{_PICKUP}, normalised pairs"),
    _rival("one-form", "one_form", "Cheng, Nie and Jin in SHREC'15, landmarks"),
    _rival("one-form-full", "one_form", "Cheng, Nie and Jin in SHREC'15, all pairs", "full"),
    _rival("skeleton", "skeleton", "Pickup, Sun, Rosin and Martin 2016"),
]
KNOWN = {method.name: method for method in _ALL}
DEFAULT = (
    "ours", "ours-unbent", "ours-published", "classical", "least-squares", "non-metric", "fast", "euclidean-random",
    "euclidean-normalised", "one-form", "skeleton",
)  # fmt: skip
INPUT = "input"


def chosen_methods(words: list[str]) -> list[Method]:
    """Turn words of the command line into methods; the mesh as it is always comes first.

    Parameters
    ----------
    words : list of str
        Names, each with settings of its own if wanted: ``ours:quality=draft,landmarks=50``.

    Returns
    -------
    list of Method
        The methods.

    Raises
    ------
    InvalidSettingsError
        If a name or setting is not known.
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
    changed: dict[str, Any] = {}
    for part in text.split(","):
        name, _, value = part.partition("=")
        known: dict[str, Any] = {each.name: each.default for each in fields(Settings)}
        default = known.get(name)
        if default is None or not value:
            raise InvalidSettingsError(f"{part!r} is not a setting with a value, such as quality=draft.")
        try:
            changed[name] = _TRUTH[value.lower()] if isinstance(default, bool) else type(default)(value)
        except (ValueError, KeyError) as error:
            raise InvalidSettingsError(f"{name} cannot be {value!r}.") from error
    return changed
