"""The options of the method and of a run as Blender properties, shared by the operators and the panel."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import Any, ClassVar

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from ..blender.records.record import read_record
from ..blender.results.result_writing import recolour_patch
from ..blender.words.limb_words import PARTS
from ..blender.words.wording import CONTEXT, told
from ..core import InvalidSettingsError, Settings
from ..core.distances.kinds import KINDS
from ..core.method_api.catalogue import methods
from ..core.method_api.options import Option, options_of
from ..core.symmetry.limb_names import names_in

_DEFAULT = Settings()
DISTANCES = [(name, kind.label, kind.help) for name, kind in KINDS.items()]

TRANSFER_ITEMS = [
    ("GROUPS", "Weights", "Vertex groups; with those of a rig its rest pose as a shape key, and its modifier"),
    ("UVS", "UV", "UV maps"),
    ("COLOURS", "Colours", "Colour attributes"),
    ("KEYS", "Keys", "Shape keys, as changes of the shape: turned and sized as the mesh is here"),
    ("MATERIALS", "Materials", "Materials, by face"),
]

MESH_ITEMS = (
    ("AUTO", "By Itself", "As shown where a rig, shape keys or modifiers move the mesh, else the base mesh"),
    ("BASE", "Base Mesh", "The mesh itself: its Basis, without modifiers"),
    ("SHOWN", "As Shown", "The mesh as modifiers, armature and shape keys show it at the current frame"),
)


def transfer_flag(kind: str) -> str:
    """Return the name of the check box for a kind of transferable data.

    Parameters
    ----------
    kind : str
        One of the kinds of `TRANSFER_ITEMS`.

    Returns
    -------
    str
        Name of the property.
    """
    return f"transfer_{kind.lower()}"


def method_items(_owner: Any, _context: bpy.types.Context | None) -> list[tuple[str, str, str, str, int]]:
    """List the methods on Blender's first request, as importing them all would slow down enabling the extension.

    Parameters
    ----------
    _owner, _context
        Passed by Blender; not used.

    Returns
    -------
    list of tuple
        Name, label, help, icon and number of each method. The strings must stay alive for Blender.
    """
    if not MethodProperties.listed_methods:
        found = methods().values()
        MethodProperties.listed_methods = [(each.name, each.label, each.help, "NONE", each.rank) for each in found]
    return MethodProperties.listed_methods


def _property(name: str, about: Option, default: Any) -> Any:
    """Convert an option to a Blender property."""
    words = {"name": about.label, "description": about.help, "translation_context": CONTEXT}
    if name == "method":
        return EnumProperty(items=method_items, default=0, **words)  # 0 is the number of our method
    if about.choices:
        items = [(choice.value, choice.label, choice.help) for choice in about.choices]
        return EnumProperty(items=items, default=default, **words)
    if default is None:
        return StringProperty(**words)
    bounds = {"min": about.low, "max": about.high, "soft_max": about.soft_high}
    if about.above:
        bounds["min"] = 10.0**-about.digits
    bounds = {each: type(default)(bound) for each, bound in bounds.items() if bound is not None}
    if isinstance(default, int):
        return IntProperty(default=default, **bounds, **words)
    subtype = "FACTOR" if (about.low, about.high) == (0, 1) else "NONE"
    return FloatProperty(default=default, precision=about.digits, subtype=subtype, **bounds, **words)


class MethodProperties:
    """Properties that mirror `Settings`, created from its options."""

    listed_methods: ClassVar[list[tuple[str, str, str, str, int]]] = []  # items of the property `method`, once listed
    __annotations__ = {
        name: _property(name, about, getattr(_DEFAULT, name)) for name, about in options_of(Settings).items()
    }


PART_ITEMS = (
    ("ALL", "All Limbs", "The whole body"),
    *((name, label, f"Only this: {label}") for name, label in PARTS.items()),
)
METHOD_NAMES = tuple(MethodProperties.__annotations__)


class RequestProperties:
    """Properties for what is read and where the result goes; mixed into the operator and the panel's options."""

    value: FloatProperty(  # type: ignore[valid-type]
        name="Value",
        translation_context=CONTEXT,
        description="Value of the shape key after the run: 0 is the pose, 1 the canonical form",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    mesh: EnumProperty(  # type: ignore[valid-type]
        name="Mesh",
        translation_context=CONTEXT,
        description="Mesh that the form is computed from",
        items=MESH_ITEMS,
        default="BASE",
    )
    result: EnumProperty(  # type: ignore[valid-type]
        name="Written As",
        translation_context=CONTEXT,
        description="Where the form is written",
        items=(
            ("KEY", "Shape Key", "A shape key of the mesh"),
            ("OBJECT", "New Object", "A new object with the form as its shape key; the mesh is not touched"),
        ),
        default="KEY",
    )
    objects: EnumProperty(  # type: ignore[valid-type]
        name="Several Objects",
        translation_context=CONTEXT,
        description="Which of several selected objects are one body, with one slider",
        items=(
            ("TOUCHING", "Touching as One", "Objects that lie on, in or inside each other are one body"),
            ("TOGETHER", "All as One", "All are one run, with one report and one slider"),
            ("EACH", "Each", "Each object gets its own form, even if it touches others"),
        ),
        default="TOUCHING",
    )
    reference: StringProperty(  # type: ignore[valid-type]
        name="Reference",
        translation_context=CONTEXT,
        description="Object with a form of the same or a like body: the form is turned as that one is, and its limbs "
        "are numbered and coloured alike",
    )
    feature_group: StringProperty(  # type: ignore[valid-type]
        name="Vertex Group",
        translation_context=CONTEXT,
        description="Vertex group that holds the feature points, one vertex per limb; empty to detect them",
    )


REQUEST_NAMES = tuple(RequestProperties.__annotations__)


class TransferProperties:
    """What to transfer from the reference, one check box each."""

    __annotations__ = {
        transfer_flag(kind): BoolProperty(
            name=name,
            translation_context=CONTEXT,
            description=f"Transfer: {about}",
            default=kind in ("GROUPS", "UVS"),
        )
        for kind, name, about in TRANSFER_ITEMS
    }


class CanonicalFormPatch(bpy.types.PropertyGroup):
    """A line in the list of patches; its name is that of the vertex group."""

    colour: FloatVectorProperty(  # type: ignore[valid-type]
        name="Colour", translation_context=CONTEXT,
        description="Colour of the patch",
        subtype="COLOR",
        size=3,
        min=0.0,
        max=1.0,
        update=lambda patch, _: recolour_patch(patch.id_data, list(patch.id_data.canonical_form_patches).index(patch),
                                               tuple(patch.colour)),
    )  # fmt: skip
    size: IntProperty(name="Vertices", translation_context=CONTEXT, description="Number of vertices")  # type: ignore[valid-type]


def list_patches(mesh: bpy.types.Mesh) -> None:
    """Fill the panel's list of patches from the record of the mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    """
    for name in ("canonical_form_patches", "canonical_form_patch"):
        mesh.property_unset(name)
        mesh.pop(name, None)  # Blender 5 makes a second, visible copy of data from older files
    record = read_record(mesh)
    if record is None or not record.has_patches:
        return
    for name, colour, size in zip(record.patch_names, record.palette, record.report.patch_sizes, strict=True):
        patch = mesh.canonical_form_patches.add()
        patch.name, patch.size, patch.colour = name, size, colour


def chosen_value(owner: Any, name: str) -> Any:
    """Return the value of an option; a file of another version may have a value that this version does not have.

    Parameters
    ----------
    owner : MethodProperties or RequestProperties
        An operator or the scene's properties.
    name : str
        Name of the property.

    Returns
    -------
    object
        Its value; the default if the value is unknown in this version.
    """
    value = getattr(owner, name)
    if value != "":
        return value
    if name in METHOD_NAMES:
        return getattr(_DEFAULT, name) or ""
    return owner.bl_rna.properties[name].default


def settings_of(owner: Any) -> Settings:
    """Convert properties to settings.

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
        If the feature points are not a list of integers.
    """
    options = {name: chosen_value(owner, name) for name in METHOD_NAMES}
    try:
        options["feature_points"] = [int(word) for word in owner.feature_points.replace(",", " ").split()] or None
    except ValueError as error:
        raise InvalidSettingsError(
            told(
                "Feature points must be vertex indices separated by commas; got {feature_points!r}.",
                feature_points=owner.feature_points,
            )
        ) from error
    options["feature_names"] = names_in(owner.feature_names)
    return Settings(**options)


CLASSES = (CanonicalFormPatch,)


def register() -> None:
    """Register the properties and add those of the list of patches to the mesh."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Mesh.canonical_form_patches = CollectionProperty(type=CanonicalFormPatch)
    bpy.types.Mesh.canonical_form_patch = IntProperty(
        name="Patch", translation_context=CONTEXT, description="Active row of the list of patches"
    )


def unregister() -> None:
    """Remove them from the mesh, and unregister them."""
    del bpy.types.Mesh.canonical_form_patch
    del bpy.types.Mesh.canonical_form_patches
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
