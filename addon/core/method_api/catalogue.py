"""The description of a method, and the methods by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ..run.monitor import Monitor, Plan
from .registry import declared_method, declared_methods

if TYPE_CHECKING:
    from .method_result import MethodResult
    from .settings import Settings
    from .surface_features import SurfaceFeatures

FEATURE_OPTIONS = ("prominence", "feature_count", "diffusion_time", "eigenpairs")  # of every method
PATIENT = 1e-5  # relative decrease of the stress in a step at which the rivals and the paper's as published stop
# stages of every run, before those of its method
DETECTION: Plan = {"Coarse mesh": 28, "Triangulation": 2, "Spectrum": 7, "Feature points": 2, "Patches": 1}


class Method(NamedTuple):
    """A method that unfolds a surface.

    Attributes
    ----------
    name : str
        Name in settings and on the command line.
    label : str
        Name in a panel.
    help : str
        One line: what it does.
    source : str
        Authors and year.
    unfold : callable
        Takes `SurfaceFeatures`, `Settings` and a `Monitor`, and returns a `MethodResult`.
    stages : mapping of str to float
        Its stages in their order, with weights; feature detection weighs 40.
    uses : tuple of str
        Names of the options that it uses, besides those of the feature points.
    pairs : {'none', 'patches', 'all', 'landmarks'}
        Vertices between which it keeps distances at quality 'full': none but landmarks, those of each patch, all; or
        all and landmarks at any quality.
        Determines the estimates of memory and time.
    rank : int
        Its position in lists, and its number in saved files; unique.
    area_kept : bool
        Whether the form is scaled to the area of its input; else it has the scale that its distances have given it.
    fixed : mapping of str to object
        Options that are part of the method; they override the settings.
    """

    name: str
    label: str
    help: str
    source: str
    unfold: Callable[[SurfaceFeatures, Settings, Monitor], MethodResult]
    stages: Plan
    uses: tuple[str, ...] = ()
    pairs: Literal["none", "patches", "all", "landmarks"] = "landmarks"
    rank: int = 100
    area_kept: bool = False
    fixed: Mapping[str, Any] = MappingProxyType({})

    def settings(self, wanted: Settings) -> Settings:
        """Replace the settings that the method itself fixes. `wanted`: the settings of the user."""
        return replace(wanted, **self.fixed) if self.fixed else wanted


def methods() -> dict[str, Method]:
    """Collect the methods of all files in the room `methods`.

    Examples
    --------
    >>> list(methods())[:3]
    ['straight', 'classical', 'least_squares']
    """
    return declared_methods()


def method_named(name: str) -> Method:
    """Look up a method by its name.

    `name`: its name.

    Examples
    --------
    >>> method_named("fast").label
    'Fast MDS'
    """
    found: Method = declared_method(name)
    return found
