"""The methods themselves: arrays in, arrays out, numpy and scipy only. Start at README.md beside this file."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .run.errors import (
    CancelledError,
    CanonicalFormError,
    InvalidFileError,
    InvalidMeshError,
    InvalidSettingsError,
    SolverError,
    TooLargeError,
)

if TYPE_CHECKING:
    from .canonical import canonical_form, canonical_forms
    from .contacts import find_contacts
    from .distance_fields import distance_field, heat_geodesics
    from .features import feature_patches
    from .files.result_files import load, save
    from .fused.found_contacts import Contacts
    from .limbs import limb_shapes
    from .matches import match
    from .method_api.settings import Settings
    from .modelling.mannequins import mannequin
    from .poses import pose_like
    from .results import CanonicalForm, FeaturePatches, Match, PosedLike, Rigged, Stance
    from .rigging.skeleton import Skeleton
    from .rigs import rig
    from .run.kept_stages import KeptStages
    from .stances import stance_by_bones, stance_by_match
    from .transfers import require_fit, transferred, transferred_corners, transferred_labels, transferred_shape

__version__ = "1.0.0"

__all__ = [
    "CancelledError",
    "CanonicalForm",
    "CanonicalFormError",
    "Contacts",
    "FeaturePatches",
    "InvalidFileError",
    "InvalidMeshError",
    "InvalidSettingsError",
    "KeptStages",
    "Match",
    "PosedLike",
    "Rigged",
    "Settings",
    "Skeleton",
    "SolverError",
    "Stance",
    "TooLargeError",
    "canonical_form",
    "canonical_forms",
    "distance_field",
    "feature_patches",
    "find_contacts",
    "heat_geodesics",
    "limb_shapes",
    "load",
    "mannequin",
    "match",
    "pose_like",
    "require_fit",
    "rig",
    "save",
    "stance_by_bones",
    "stance_by_match",
    "transferred",
    "transferred_corners",
    "transferred_labels",
    "transferred_shape",
]

_DOORS = {
    "Settings": "method_api.settings",
    "CanonicalForm": "results",
    "Contacts": "fused.found_contacts",
    "FeaturePatches": "results",
    "KeptStages": "run.kept_stages",
    "Match": "results",
    "PosedLike": "results",
    "Rigged": "results",
    "Skeleton": "rigging.skeleton",
    "Stance": "results",
    "canonical_form": "canonical",
    "canonical_forms": "canonical",
    "distance_field": "distance_fields",
    "feature_patches": "features",
    "find_contacts": "contacts",
    "heat_geodesics": "distance_fields",
    "limb_shapes": "limbs",
    "load": "files.result_files",
    "mannequin": "modelling.mannequins",
    "match": "matches",
    "pose_like": "poses",
    "rig": "rigs",
    "save": "files.result_files",
    "stance_by_bones": "stances",
    "stance_by_match": "stances",
    "require_fit": "transfers",
    "transferred": "transfers",
    "transferred_corners": "transfers",
    "transferred_labels": "transfers",
    "transferred_shape": "transfers",
}


def __getattr__(name: str) -> Any:
    """Import a name on first access, so that enabling the extension stays instant."""
    if name in _DOORS:
        return getattr(import_module(f".{_DOORS[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
