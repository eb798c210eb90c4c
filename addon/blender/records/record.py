"""The record on a mesh of what the last run wrote to it.

It stores names with fingerprints, so that exactly the items written can be removed again. An item that has been
renamed, replaced or changed since then belongs to the user and is kept.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import bpy

from ...core import CanonicalFormError
from ..mesh_items.active_items import ActiveItems, ItemNames
from ..words.wording import told
from .form_report import FormReport
from .stored_values import flag, listed, maybe, named, real, whole, words

RECORD_PROPERTY = "canonical_form_record"
_LONGEST = 10**7  # characters of a record; ours have thousands, and panels read them repeatedly

Fingerprints = dict[str, str | None]  # by name; None while it is being written, and in records of the first builds


@dataclass
class InBetweens:
    """The shape keys between pose and form.

    Attributes
    ----------
    keys : dict of str to str or None
        Fingerprints of the keys by name, in order from pose to form.
    animated_before : bool
        Whether the shape keys had animation data before the drivers were added.
    value : float
        Value of the form's key before it had a driver.
    """

    keys: Fingerprints
    animated_before: bool
    value: float


class Part(NamedTuple):
    """An object as a part of a body of several objects.

    Attributes
    ----------
    number : int
        Index in the body, from 0; part 0 has the slider.
    placement : list of list of float
        The transform from its local space to the space of the body, 4 by 4.
    body : str
        Fingerprint of the run, identical for all parts.
    """

    number: int
    placement: list[list[float]]
    body: str


@dataclass
class Record:
    """What the last run wrote to a mesh.

    Attributes
    ----------
    report : FormReport
        The report, for the panel.
    active_before : ActiveItems
        The items that were active before the run.
    basis : str or None
        Name of the Basis, if the run added it.
    basis_fingerprint : str or None
        Fingerprint of that Basis; None if unknown.
    keys, groups, colours, hidden : dict of str to str or None
        Fingerprints by name of the form's shape key, the vertex groups, the colour attributes and the hidden
        attributes. The first group holds the feature points, the next ones hold one patch each; they are followed
        by the confidence group of a match.
    palette : list of list of float
        Linear red, green and blue of each patch; empty without patches.
    limbs : list of bool
        For each patch, whether the key removes its pose; empty if it does so for all.
    in_betweens : InBetweens or None
        The keys between pose and form, if any.
    keyframed : bool
        Whether the run keyframed its keys, one per frame.
    part : Part or None
        The part of a body of several objects that this mesh is; None if the form is of this object alone.
    """

    report: FormReport
    active_before: ActiveItems
    basis: str | None = None
    basis_fingerprint: str | None = None
    keys: Fingerprints = field(default_factory=dict)
    groups: Fingerprints = field(default_factory=dict)
    colours: Fingerprints = field(default_factory=dict)
    hidden: Fingerprints = field(default_factory=dict)
    palette: list[list[float]] = field(default_factory=list)
    limbs: list[bool] = field(default_factory=list)
    in_betweens: InBetweens | None = None
    keyframed: bool = False
    part: Part | None = None

    @property
    def has_form(self) -> bool:
        """Whether the run wrote a form or a pose, and not only patches or feature points."""
        return bool(self.keys)

    @property
    def has_patches(self) -> bool:
        """Whether the run wrote patches, and not only feature points."""
        return bool(self.palette)

    @property
    def patch_count(self) -> int:
        """Number of patches written."""
        return len(self.palette)

    @property
    def patch_names(self) -> list[str]:
        """Names of the patches' vertex groups, in order; empty without patches."""
        return list(self.groups)[1 : 1 + self.patch_count]

    @property
    def straightened(self) -> list[bool]:
        """For each patch, whether the key removes its pose; empty without a form."""
        return (self.limbs or [True] * self.patch_count) if self.has_form else []

    @property
    def in_between_keys(self) -> Fingerprints:
        """Fingerprints by name of the keys between pose and form."""
        return self.in_betweens.keys if self.in_betweens is not None else {}

    def written_items(self) -> ItemNames:
        """List the items that the run wrote.

        Returns
        -------
        ItemNames
            Their names; the shape keys include None if the run did not add the Basis.
        """
        return ItemNames(
            shape_keys={*self.keys, *self.in_between_keys, self.basis},
            groups=set(self.groups),
            colours=set(self.colours),
        )

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Record:
        """Build a record from its JSON object, written by this version or an earlier one.

        Parameters
        ----------
        data : dict
            As `as_json` returns it.

        Returns
        -------
        Record
            The record.

        Raises
        ------
        ValueError
            If the data is not that of a record.
        """
        try:
            record = cls(
                report=FormReport.from_json(data["report"]),
                active_before=ActiveItems(**named(lambda value: maybe(words, value), data["before"])),
                basis=maybe(words, data["basis"]),
                basis_fingerprint=maybe(words, data.get("basis_print")),
                keys=_fingerprints(data["key"]),
                groups=_fingerprints(data["groups"]),
                colours=_fingerprints(data["colours"]),
                hidden=_fingerprints(data.get("hidden", {})),
                palette=listed(lambda colour: listed(real, colour, 3), data.get("palette", [])),
                limbs=listed(flag, data.get("limbs", [])),
                keyframed=flag(data.get("keyframed", len(data["key"]) > 1)),
            )
            if "between" in data:
                animated, value = flag(data["animated_before"]), real(data["value"])
                record.in_betweens = InBetweens(_fingerprints(data["between"]), animated, value)
            if "part" in data:
                part = data["part"]
                placement = listed(lambda row: listed(real, row, 4), part["placement"], 4)
                record.part = Part(whole(part["number"]), placement, words(part["body"]))
            record._require_agreement()
        except (AttributeError, KeyError, TypeError) as error:
            raise ValueError("These are not the data of a record.") from error
        return record

    def _require_agreement(self) -> None:
        """Reject a record whose lists disagree on the number of patches."""
        count = self.patch_count
        if count and not len(self.report.feature_points) == len(self.report.patch_sizes) == count < len(self.groups):
            raise ValueError("There is not one of each for every patch.")
        if self.limbs and len(self.limbs) != count:
            raise ValueError("There is not one limb for every patch.")

    def as_json(self) -> dict[str, Any]:
        """Convert the record to a JSON object.

        Returns
        -------
        dict
            A dictionary that `from_json` reads.
        """
        data: dict[str, Any] = {
            "report": self.report.as_json(),
            "before": self.active_before._asdict(),
            "basis": self.basis,
            "key": self.keys,
            "groups": self.groups,
            "colours": self.colours,
            "hidden": self.hidden,
            "palette": self.palette,
        }
        if self.basis is not None:
            data["basis_print"] = self.basis_fingerprint
        if self.limbs:
            data["limbs"] = self.limbs
        if self.in_betweens is not None:
            data["between"] = self.in_betweens.keys
            data["animated_before"] = self.in_betweens.animated_before
            data["value"] = self.in_betweens.value
        if self.keyframed:
            data["keyframed"] = True
        if self.part is not None:
            data["part"] = self.part._asdict()
        return data


def _fingerprints(value: Any) -> Fingerprints:
    """Read fingerprints by name from stored data."""
    return named(lambda fingerprint: maybe(words, fingerprint), value)


def read_record(mesh: bpy.types.Mesh, *, containing: str = "") -> Record | None:
    """Read the record of the last run on a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    containing : str
        Return only a record whose text contains this.

    Returns
    -------
    Record or None
        The record; None if there is none.
    """
    text = mesh.get(RECORD_PROPERTY)
    if not isinstance(text, str) or len(text) > _LONGEST or containing not in text:
        return None
    try:
        return Record.from_json(json.loads(text))
    except (ValueError, RecursionError):  # a property of that name from the user, or from an untrusted file
        return None


def require_record(mesh: bpy.types.Mesh) -> Record:
    """Read the record of a mesh, which must have one.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    Record
        The record.

    Raises
    ------
    CanonicalFormError
        If there is none.
    """
    record = read_record(mesh)
    if record is None:
        raise CanonicalFormError(told("{name} has no canonical form. Compute it first.", name=mesh.name))
    return record


def write_record(mesh: bpy.types.Mesh, record: Record) -> None:
    """Write a record to a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    record : Record
        The record.
    """
    remove_record(mesh)
    mesh[RECORD_PROPERTY] = json.dumps(record.as_json())


def remove_record(mesh: bpy.types.Mesh) -> None:
    """Remove the record of a mesh, if it has one.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    """
    mesh.pop(RECORD_PROPERTY, None)
