"""The options of the method as Blender properties, shared by the operator and the panel."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..blender.chosen_features import CHOSEN_GROUP
from ..blender.records import record_of
from ..blender.result_writing import recolour_patch
from ..core import InvalidSettingsError, Settings

_DEFAULT = Settings()
DISTANCES = (
    ("heat", "Heat Geodesic", "Length of the shortest way on the surface, by the heat method"),
    ("fast_marching", "Fast Marching", "Length of the shortest way on the surface, by fast marching"),
    ("biharmonic", "Biharmonic", "Smooth distance that knows the shape at large"),
    ("commute_time", "Commute Time", "How long a random walk there and back takes; knows all ways at once"),
)


class MethodProperties:
    """Properties that mirror `Settings`; mixed into everything that lets the user choose them."""

    method: EnumProperty(  # type: ignore[valid-type]
        name="Method",
        description="How the surface is unfolded",
        items=(
            ("local_features", "Local Features", "The method of this extension; all others are there to compare with"),
            ("classical", "Classical MDS", "Geodesics by classical scaling: squashes limbs (Elad and Kimmel 2003)"),
            ("least_squares", "Least-Squares MDS", "Geodesics by SMACOF with unit weights (Elad and Kimmel 2003)"),
            ("non_metric", "Non-metric MDS", "The order of geodesics only (Kruskal 1964)"),
            ("fast", "Fast MDS", "Geodesics from two points an axis: FastMap (Faloutsos and Lin 1995)"),
            ("euclidean_random", "Euclidean, Random", "Vertices push each other apart (Pickup and others 2015)"),
            (
                "euclidean_normalised",
                "Euclidean, Normalised",
                "Vertices push each other apart, near ones as much as far ones (Pickup and others 2015)",
            ),
            ("one_form", "1-Form MDS", "Least-squares MDS, then edge vectors put together again (SHREC'15)"),
            ("skeleton", "Skeleton", "The curve skeleton unbends and drives the mesh (Pickup and others 2016)"),
        ),
        default=_DEFAULT.method,
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
    feature_count: IntProperty(  # type: ignore[valid-type]
        name="Number",
        description="Number of feature points, the most prominent ones; 0 to go by prominence",
        default=_DEFAULT.feature_count,
        min=0,
        soft_max=30,
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
    unbending: FloatProperty(  # type: ignore[valid-type]
        name="Unbending",
        description="How strongly the landmarks push each other apart in the end; more takes more of the pose out, and "
        "lengthens thin limbs. 3 suits the search for shapes of one kind",
        default=_DEFAULT.unbending,
        min=0.0,
        max=100.0,
        soft_max=10.0,
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
        description="Most memory that may be used, in gigabytes; 0 for 60 % of what is free",
        default=_DEFAULT.memory_limit,
        min=0.0,
        soft_max=64.0,
    )


METHOD_NAMES = tuple(MethodProperties.__annotations__)


class RequestProperties:
    """Properties that say what is read and where the result goes; mixed into the operator and the panel's choices."""

    value: FloatProperty(  # type: ignore[valid-type]
        name="Value",
        description="Value of the shape key after the run: 0 is the pose, 1 the canonical form",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    mesh: EnumProperty(  # type: ignore[valid-type]
        name="Mesh",
        description="What the form is computed of",
        items=(
            ("BASE", "Base Mesh", "The mesh itself: its Basis, without modifiers"),
            ("SHOWN", "As Shown", "What modifiers, armature and shape keys make of it at the current frame"),
        ),
        default="BASE",
    )
    result: EnumProperty(  # type: ignore[valid-type]
        name="Result",
        description="Where the form goes",
        items=(
            ("KEY", "Shape Key", "A shape key of the mesh"),
            ("OBJECT", "New Object", "A new object with the form as its shape key; the mesh is not touched"),
        ),
        default="KEY",
    )
    feature_group: StringProperty(  # type: ignore[valid-type]
        name="Vertex Group",
        description="Vertex group that holds the feature points, a vertex a limb; empty to detect them",
    )


REQUEST_NAMES = tuple(RequestProperties.__annotations__)


class CanonicalFormProperties(MethodProperties, RequestProperties, bpy.types.PropertyGroup):
    """The choices made in the panel, kept with the scene."""

    feature_source: EnumProperty(  # type: ignore[valid-type]
        name="Feature Points From",
        description="Where the feature points come from",
        items=(
            ("DETECTED", "Detected", "Where the surface ends: hands, feet, head"),
            ("GROUP", "Vertex Group", "From a vertex group, a vertex a limb"),
        ),
        default="DETECTED",
    )
    show_points: BoolProperty(  # type: ignore[valid-type]
        name="Labels in the View",
        description="Draw the feature points of the active object with their numbers in the 3D View",
        default=True,
    )
    in_betweens: IntProperty(  # type: ignore[valid-type]
        name="Keys",
        description="Number of shape keys between the pose and the form",
        default=5,
        min=1,
        max=31,
    )
    distance: EnumProperty(  # type: ignore[valid-type]
        name="Distance", description="Which distance is measured", items=DISTANCES, default="heat"
    )
    isolines: IntProperty(  # type: ignore[valid-type]
        name="Isolines",
        description="Number of lines of equal distance; 0 for none",
        default=0,
        min=0,
        soft_max=40,
    )


class CanonicalFormPatch(bpy.types.PropertyGroup):
    """A line in the list of patches; its name is that of the vertex group."""

    colour: FloatVectorProperty(  # type: ignore[valid-type]
        name="Colour",
        description="Colour of the patch",
        subtype="COLOR",
        size=3,
        min=0.0,
        max=1.0,
        update=lambda patch, _: recolour_patch(patch.id_data, list(patch.id_data.canonical_form_patches).index(patch),
                                               tuple(patch.colour)),
    )  # fmt: skip
    size: IntProperty(name="Vertices", description="Number of vertices")  # type: ignore[valid-type]


def list_patches(mesh: bpy.types.Mesh) -> None:
    """Fill the panel's list of patches from the record of the mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    """
    mesh.property_unset("canonical_form_patches")
    mesh.property_unset("canonical_form_patch")
    record = record_of(mesh)
    if record is None or not record["palette"]:
        return
    names = list(record["groups"])[1:]
    for name, colour, size in zip(names, record["palette"], record["report"]["patch_sizes"], strict=True):
        patch = mesh.canonical_form_patches.add()
        patch.name, patch.size, patch.colour = name, size, colour


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
    options = {name: getattr(owner, name) for name in METHOD_NAMES}
    try:
        options["feature_points"] = [int(word) for word in owner.feature_points.replace(",", " ").split()] or None
    except ValueError as error:
        raise InvalidSettingsError(
            f"Feature points must be vertex indices separated by commas; got {owner.feature_points!r}."
        ) from error
    return Settings(**options)


def hand_over(chosen: CanonicalFormProperties, operator: bpy.types.OperatorProperties) -> None:
    """Give the choices made in the panel to a button.

    Parameters
    ----------
    chosen : CanonicalFormProperties
        The scene's choices.
    operator : bpy.types.OperatorProperties
        Properties of the button's operator.
    """
    for name in (*METHOD_NAMES, *REQUEST_NAMES):
        setattr(operator, name, getattr(chosen, name))
    if chosen.feature_source == "DETECTED":
        operator.feature_group = ""
    else:
        operator.feature_points = ""
        operator.feature_group = chosen.feature_group or CHOSEN_GROUP


CLASSES = (CanonicalFormProperties, CanonicalFormPatch)


def register() -> None:
    """Register the properties and hang them on the scene and the mesh."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.canonical_form = PointerProperty(type=CanonicalFormProperties)
    bpy.types.Mesh.canonical_form_patches = CollectionProperty(type=CanonicalFormPatch)
    bpy.types.Mesh.canonical_form_patch = IntProperty(name="Patch", description="Line of the list of patches")


def unregister() -> None:
    """Take the properties off the scene and the mesh and unregister them."""
    del bpy.types.Mesh.canonical_form_patch
    del bpy.types.Mesh.canonical_form_patches
    del bpy.types.Scene.canonical_form
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
