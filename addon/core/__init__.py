"""The method itself: arrays in, arrays out, numpy and scipy only."""

from typing import TYPE_CHECKING, Any

from .run.errors import (
    CancelledError,
    CanonicalFormError,
    InvalidMeshError,
    InvalidSettingsError,
    SolverError,
    TooLargeError,
)
from .unfolding.settings import Settings

if TYPE_CHECKING:
    from .canonical import CanonicalForm, canonical_form
    from .unfolding.recognition import FeaturePatches, feature_patches

__all__ = [
    "CancelledError",
    "CanonicalForm",
    "CanonicalFormError",
    "FeaturePatches",
    "InvalidMeshError",
    "InvalidSettingsError",
    "Settings",
    "SolverError",
    "TooLargeError",
    "canonical_form",
    "feature_patches",
]


def __getattr__(name: str) -> Any:
    """Import the computation when it is first asked for, so that enabling the extension stays instant."""
    if name in ("CanonicalForm", "canonical_form"):
        from . import canonical

        return getattr(canonical, name)
    if name in ("FeaturePatches", "feature_patches"):
        from .unfolding import recognition

        return getattr(recognition, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
