"""The options of the method as Blender properties, shared by the operator and the panel."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..core import InvalidSettingsError, Settings

_DEFAULT = Settings()


class MethodProperties:
    """Properties that mirror `Settings`; mixed into everything that lets the user choose them."""

    value: FloatProperty(  # type: ignore[valid-type]
        name="Value",
        description="Value of the shape key: 0 is the pose, 1 the canonical form",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    quality: EnumProperty(  # type: ignore[valid-type]
        name="Quality",
        description="How much of the mesh is worked on",
        items=(
            ("draft", "Draft", "700 vertices are worked on: a quick look"),
            ("normal", "Normal", "1,600 vertices, carried back to all: about a second, a few on large meshes"),
            ("full", "Full", "All vertices and all pairs: minutes above 10,000 vertices, for reference"),
        ),
        default=_DEFAULT.quality,
    )
    preserve_detail: FloatProperty(  # type: ignore[valid-type]
        name="Preserve Detail",
        description="From 0, the bare form, to 1, the surface kept as rigid as possible",
        default=_DEFAULT.preserve_detail,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    prominence: FloatProperty(  # type: ignore[valid-type]
        name="Prominence",
        description="How far a feature point must stand out; larger gives fewer patches",
        default=_DEFAULT.prominence,
        min=0.0,
        soft_max=3.0,
    )
    feature_points: StringProperty(  # type: ignore[valid-type]
        name="Feature Points",
        description="Vertex indices to use as feature points, separated by commas; empty to detect them",
    )
    diffusion_time: FloatProperty(  # type: ignore[valid-type]
        name="Diffusion Time",
        description="Time of the Auto Diffusion Function; larger gives fewer, broader features",
        default=_DEFAULT.diffusion_time,
        min=0.001,
        max=50.0,
        soft_max=1.0,
        precision=3,
    )
    eigenpairs: IntProperty(  # type: ignore[valid-type]
        name="Eigenpairs",
        description="Number of eigenpairs of the Laplace-Beltrami operator",
        default=_DEFAULT.eigenpairs,
        min=1,
        soft_max=400,
    )
    merge_distance: FloatProperty(  # type: ignore[valid-type]
        name="Merge Distance",
        description="Feature points closer than this share of the geodesic diameter become one",
        default=_DEFAULT.merge_distance,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    start: EnumProperty(  # type: ignore[valid-type]
        name="Start",
        description="Where the minimisation of the stress starts",
        items=(
            ("intrinsic", "Surface", "From a layout that knows the surface alone, not the pose"),
            ("input", "Pose", "From the mesh as it is; the result keeps part of its pose"),
        ),
        default=_DEFAULT.start,
    )
    landmarks: IntProperty(  # type: ignore[valid-type]
        name="Landmarks",
        description="Number of points that the layout of the surface is made from",
        default=_DEFAULT.landmarks,
        min=4,
        soft_max=500,
    )
    smoothing: FloatProperty(  # type: ignore[valid-type]
        name="Smoothing",
        description="How widely geodesics are averaged, as a share of the area; 0 measures them as they are, and they "
        "then shorten where joints bend",
        default=_DEFAULT.smoothing,
        min=0.0,
        max=10.0,
        soft_max=1.0,
        precision=3,
    )
    arrangement_share: FloatProperty(  # type: ignore[valid-type]
        name="Arrangement Weight",
        description="How much the landmarks pull at each other, against the weight their patches hold them with",
        default=_DEFAULT.arrangement_share,
        min=0.0,
        max=100.0,
        soft_max=20.0,
    )
    iterations: IntProperty(  # type: ignore[valid-type]
        name="Iterations",
        description="Most steps of the minimisation",
        default=_DEFAULT.iterations,
        min=0,
        soft_max=1000,
    )
    tolerance: FloatProperty(  # type: ignore[valid-type]
        name="Tolerance",
        description="Stop when a step lowers the stress by less than this share of it",
        default=_DEFAULT.tolerance,
        min=0.0,
        soft_max=0.01,
        precision=8,
    )
    extrapolation: IntProperty(  # type: ignore[valid-type]
        name="Extrapolation",
        description="Number of earlier steps from which the next is extrapolated; 0 for plain steps",
        default=_DEFAULT.extrapolation,
        min=0,
        soft_max=12,
    )
    as_published: BoolProperty(  # type: ignore[valid-type]
        name="As Published",
        description="Follow the paper to the letter; the patches may come apart",
        default=_DEFAULT.as_published,
    )
    memory_limit: FloatProperty(  # type: ignore[valid-type]
        name="Memory Limit",
        description="Most memory that may be used, in gigabytes",
        default=_DEFAULT.memory_limit,
        min=0.001,
        soft_max=64.0,
    )


METHOD_NAMES = tuple(MethodProperties.__annotations__)


class CanonicalFormProperties(MethodProperties, bpy.types.PropertyGroup):
    """The choices made in the panel, kept with the scene."""


def settings_of(owner: MethodProperties) -> Settings:
    """Turn properties into settings.

    Parameters
    ----------
    owner : MethodProperties
        An operator or the scene's properties.

    Returns
    -------
    Settings
        The options.

    Raises
    ------
    InvalidSettingsError
        If the feature points are not a list of whole numbers.
    """
    options = {name: getattr(owner, name) for name in METHOD_NAMES if name != "value"}
    try:
        options["feature_points"] = [int(word) for word in owner.feature_points.replace(",", " ").split()] or None
    except ValueError as error:
        raise InvalidSettingsError(
            f"Feature points must be vertex indices separated by commas; got {owner.feature_points!r}."
        ) from error
    return Settings(**options)


def register() -> None:
    """Register the properties and hang them on the scene."""
    bpy.utils.register_class(CanonicalFormProperties)
    bpy.types.Scene.canonical_form = PointerProperty(type=CanonicalFormProperties)


def unregister() -> None:
    """Take the properties off the scene and unregister them."""
    del bpy.types.Scene.canonical_form
    bpy.utils.unregister_class(CanonicalFormProperties)
