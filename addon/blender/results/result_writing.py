"""Writes results to a mesh: shape key, vertex groups, colours and hidden attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..mesh_items.active_items import (
    active_items,
    active_keys_elsewhere,
    existing_items,
    restore_active_items,
    restore_active_keys,
)
from ..mesh_items.colour_attributes import add_colours
from ..mesh_items.fingerprints import colour_fingerprint, fingerprint, key_fingerprint, members_fingerprint
from ..mesh_items.group_weights import fill_group
from ..mesh_items.slider import release
from ..objects.mesh_reading import basis_positions
from ..records.form_key import require_form_key, unchanged_form_key
from ..records.hidden_attributes import HIDDEN_CONTACTS, HIDDEN_FORM, HIDDEN_PATCHES, patches_of
from ..records.record import Part, Record, read_record, require_record, write_record
from ..words.wording import listed, told
from .in_betweens import is_animated, remove_in_betweens, value_path
from .result_clearing import clear_results, remove_results

if TYPE_CHECKING:
    from ...core.numerics.arrays import BoolArray, FloatArray
    from ...core.results import AnyResult
    from ..mesh_items.palette import Colours
    from ..records.form_report import FormReport
    from .match_values import MatchValues

SHAPE_KEY = "Canonical Form"
FEATURE_GROUP = "Feature Points"
PATCH_GROUP = "Patch {}"
FIELD_COLOURS = "Auto Diffusion Function"
PATCH_COLOURS = "Patches"
MATCH_COLOURS = "Match"
CONFIDENCE_GROUP = "Match Confidence"
CONTACT_GROUP = "Contacts"
KEPT = "{} (kept)"


def write_results(
    obj: bpy.types.Object,
    found: AnyResult,
    colours: Colours,
    report: FormReport,
    *,
    value: float = 1.0,
    patches: bool = True,
    part: Part | None = None,
    carried: MatchValues | None = None,
    live: bool = False,
) -> None:
    """Write results to a mesh as shape key, vertex groups and colours, replacing those of an earlier run.

    The shape key of an earlier run is kept and its positions replaced, so that its animation, drivers and dependent
    keys stay. After an error, everything written so far is removed again.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode. Objects that share its mesh show the results as well.
    found : CanonicalForm, PosedLike or FeaturePatches
        The results.
    colours : Colours
        Colours of the fields and patches.
    report : FormReport
        The report, stored in the record.
    value : float
        Value of the shape key, 0 to 1.
    patches : bool
        Write the patches too, and not only the feature points.
    part : Part or None
        The part of a body of several objects that this object is.
    carried : MatchValues or None
        Values that show the match with the object that provides the pose.
    live : bool
        Whether to update the form only: the value of its key stays, and groups and colours stay if the patches are the
        same.
    """
    from ...core import FeaturePatches, Stance

    mesh = obj.data
    patches = patches and not isinstance(found, Stance)
    form = None if isinstance(found, FeaturePatches) else found.vertices
    old, active, elsewhere = read_record(mesh), active_items(obj), active_keys_elsewhere(obj)
    same = old is not None and key_name(old.report) == key_name(report)
    one_form = old is not None and not old.keyframed  # the command line can write one a frame
    kept_key = unchanged_form_key(mesh) if form is not None and same and one_form else None
    record = Record(report, active, part=part)
    if old is not None:
        if kept_key is not None:
            record.basis, record.basis_fingerprint = old.basis, old.basis_fingerprint
        record.active_before = active.replaced(old.written_items(), by=old.active_before)
    surface_stays = (
        live
        and old is not None
        and kept_key is not None
        and carried is None
        and patches
        and _is_same_surface(obj, old, found, colours)
    )
    if old is not None and surface_stays:
        release(mesh.shape_keys)
        remove_in_betweens(obj)
        record.groups, record.colours, record.hidden, record.palette = old.groups, old.colours, old.hidden, old.palette
    elif old is not None:
        left = remove_results(obj, old, keep_key=kept_key is not None)
        if form is not None:
            for name in {*old.keys, *old.in_between_keys} & {*left}:  # both at once would show no form
                key = mesh.shape_keys.key_blocks[name]
                key.value, key.mute = 0.0, key.mute or is_animated(mesh.shape_keys, value_path(key))
        left = _put_aside(obj, old, left)
        if left:
            report.warnings.append(
                told("Kept beside the new results, since they may hold your changes: {left}.", left=listed(left))
            )
        if mesh.shape_keys is not None and mesh.shape_keys.reference_key.name == old.basis:  # next to other keys
            record.basis, record.basis_fingerprint = old.basis, old.basis_fingerprint
    done = False
    try:
        if form is not None:
            _write_key(obj, record, kept_key, form, kept_key.value if live and kept_key is not None else value)
        if surface_stays:
            shown = list(record.colours)[-1]
        elif isinstance(found, Stance):
            shown = ""
        else:
            _write_groups(obj, record, found, patches)
            shown = _write_colours(obj, record, FIELD_COLOURS, colours.field)
            if patches:
                record.palette = colours.palette
                shown = _write_colours(obj, record, PATCH_COLOURS, colours.patches)
                HIDDEN_PATCHES.write(mesh, record, found.patches)
                if _touched(found).any():
                    HIDDEN_CONTACTS.write(mesh, record, _touched(found))
        if carried is not None:
            _write_confidence(obj, record, carried.confidence)
            shown = _write_colours(obj, record, MATCH_COLOURS, carried.colours)
        if form is not None and patches:
            HIDDEN_FORM.write(mesh, record, form)
        done = True
    finally:
        write_record(mesh, record)
        if not done:
            clear_results(obj, unconfirmed=True)
    restore_active_items(obj, active.kept(existing_items(obj), otherwise=record.active_before))
    if form is not None and active.shape_key is None:
        obj.active_shape_key_index = mesh.shape_keys.key_blocks.find(next(iter(record.keys)))
    kept = old is not None and active.colour is not None and record.active_before.colour is not None  # user's choice
    if shown and not kept:
        mesh.color_attributes.active_color_name = shown
    restore_active_keys(elsewhere)
    mesh.update()


def key_name(report: FormReport) -> str:
    """Return the name for the shape key of a result.

    Parameters
    ----------
    report : FormReport
        The report of the run.

    Returns
    -------
    str
        The name; Blender appends a number if the user has a key of that name.
    """
    return SHAPE_KEY if report.like is None else report.like.key


def refill_key(obj: bpy.types.Object, positions: FloatArray, limbs: list[bool]) -> None:
    """Replace the positions of the form's shape key by the form of some limbs.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode; the form's key is unchanged.
    positions : (n, 3) ndarray of float
        The positions.
    limbs : list of bool
        For each patch, whether its pose is removed.

    Raises
    ------
    CanonicalFormError
        If the key has been removed or changed.
    """
    mesh = obj.data
    key, record = require_form_key(mesh), require_record(mesh)
    key.points.foreach_set("co", positions.astype(np.float32).ravel())
    record.keys[key.name] = key_fingerprint(key)
    record.limbs = limbs
    write_record(mesh, record)
    mesh.update()


def recolour_patch(mesh: bpy.types.Mesh, number: int, colour: tuple[float, float, float]) -> None:
    """Change the colour of a patch, if its colours are still those of the last run.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh. In Edit Mode it is left unchanged.
    number : int
        Index of the patch, from 0.
    colour : tuple of float
        Linear red, green and blue.
    """
    record, patches = read_record(mesh), patches_of(mesh)
    if record is None or patches is None or number >= record.patch_count:
        return
    if np.allclose(record.palette[number], colour, atol=1e-5):
        return
    for name, known in record.colours.items():
        attribute = mesh.color_attributes.get(name)
        unchanged = attribute is not None and known == colour_fingerprint(attribute)
        if not unchanged or not name.startswith(PATCH_COLOURS):
            continue
        values = np.empty(4 * len(attribute.data), dtype=np.float32)
        attribute.data.foreach_get("color", values)
        values.reshape(-1, 4)[patches == number, :3] = colour
        attribute.data.foreach_set("color", values)
        record.colours[name] = colour_fingerprint(attribute)
    record.palette[number] = list(colour)
    write_record(mesh, record)
    mesh.update()


def _put_aside(obj: bpy.types.Object, old: Record, names: list[str]) -> list[str]:
    """Rename groups that the user has changed, so that new ones get their names; return the new names.

    Keys and colours keep theirs, by which animation and materials find them.
    """
    renamed = {}
    for name in [each for each in names if old.groups.get(each) and each in obj.vertex_groups]:  # a record may lie
        group = obj.vertex_groups[name]
        group.name = KEPT.format(name)
        renamed[name] = group.name
        _follow(obj, name, group.name)
    return [renamed.get(name, name) for name in names]


def _follow(obj: bpy.types.Object, group: str, called: str) -> None:
    """Let modifiers and masks of keys that use a renamed vertex group use it still."""
    keys = obj.data.shape_keys.key_blocks if obj.data.shape_keys is not None else ()
    for owner in (*obj.modifiers, *keys):
        for each in owner.bl_rna.properties:
            named = each.type == "STRING" and not each.is_readonly and each.identifier.startswith("vertex_group")
            if named and getattr(owner, each.identifier) == group:
                setattr(owner, each.identifier, called)


def _is_same_surface(obj: bpy.types.Object, old: Record, found: AnyResult, colours: Colours) -> bool:
    """Return whether groups and colours of the earlier run equal the new ones, so that they can stay."""
    mesh = obj.data
    known = patches_of(mesh)
    return (
        old.report.like is None
        and old.report.feature_points == found.feature_points.tolist()
        and old.palette == colours.palette
        and known is not None
        and np.array_equal(known, found.patches)
        and old.colours.get(FIELD_COLOURS) == fingerprint(colours.field)
        and all(name in obj.vertex_groups for name in old.groups)
        and _touched(found).any() == any(name.startswith(CONTACT_GROUP) for name in old.groups)
        and all(name in mesh.color_attributes for name in old.colours)
    )


def _write_key(
    obj: bpy.types.Object, record: Record, kept_key: bpy.types.ShapeKey | None, form: FloatArray, value: float
) -> None:
    mesh = obj.data
    if mesh.shape_keys is None:
        rest = fingerprint(basis_positions(mesh))
        basis = obj.shape_key_add(name="Basis", from_mix=False)
        record.basis, record.basis_fingerprint = basis.name, rest
    key = kept_key or obj.shape_key_add(name=key_name(record.report), from_mix=False)
    record.keys[key.name] = None
    if kept_key is None:
        key.relative_key = mesh.shape_keys.reference_key
    positions = form.astype(np.float32)
    key.points.foreach_set("co", positions.ravel())
    key.value = value
    record.keys[key.name] = fingerprint(positions)  # Blender returns the same values


def _write_groups(obj: bpy.types.Object, record: Record, found: AnyResult, patches: bool) -> None:
    members = [np.sort(found.feature_points[found.feature_points >= 0])]
    if patches:
        members += [np.flatnonzero(found.patches == index) for index in range(len(found.feature_points))]
    names = [FEATURE_GROUP, *(PATCH_GROUP.format(number) for number in range(1, len(members)))]
    contacts = np.flatnonzero(_touched(found))
    if len(contacts):
        names.append(CONTACT_GROUP)
        members.append(contacts)
    for name, vertices in zip(names, members, strict=True):
        group = obj.vertex_groups.new(name=name)
        record.groups[group.name] = None
        group.add(vertices.tolist(), 1.0, "REPLACE")
        record.groups[group.name] = members_fingerprint(vertices, np.ones(len(vertices)))


def _touched(found: AnyResult) -> BoolArray:
    """Return at which vertices skin that had grown together was parted, (n,); none but for forms that were opened."""
    contacts = getattr(found, "contacts", np.empty(0, dtype=bool))
    return contacts if len(contacts) else np.zeros(len(found.patches), dtype=bool)


def _write_confidence(obj: bpy.types.Object, record: Record, confidence: FloatArray) -> None:
    """Write the confidence of a match as a vertex group."""
    group = obj.vertex_groups.new(name=CONFIDENCE_GROUP)
    record.groups[group.name] = None
    record.groups[group.name] = fill_group(group, confidence)


def _write_colours(obj: bpy.types.Object, record: Record, name: str, colours: np.ndarray) -> str:
    """Write colours and return the attribute's name, as the attribute may move in memory later."""
    attribute = add_colours(obj, name)
    record.colours[attribute.name] = None
    values = colours.astype(np.float32)
    attribute.data.foreach_set("color", values.ravel())
    record.colours[attribute.name] = fingerprint(values)  # Blender returns the same values
    return str(attribute.name)
