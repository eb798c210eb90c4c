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
from .settings import Settings

__all__ = [
    "CancelledError",
    "CanonicalForm",
    "CanonicalFormError",
    "InvalidMeshError",
    "InvalidSettingsError",
    "Settings",
    "SolverError",
    "TooLargeError",
    "canonical_form",
]
