"""The method itself: arrays in, arrays out, numpy and scipy only."""

from .canonical import CanonicalForm, canonical_form
from .errors import (
    CancelledError,
    CanonicalFormError,
    InvalidMeshError,
    InvalidSettingsError,
    SolverError,
    TooLargeError,
)
from .recognition import FeaturePatches, feature_patches
from .settings import Settings

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
