"""The request for a run: what to compute and where to write the result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING

import bpy

from ...core import CanonicalFormError, Settings
from ..objects.body_points import BodyPoints, points_by_hand, points_on
from ..objects.chosen_features import MOST_FEATURES, members_of
from ..objects.mesh_reading import Reading
from ..records.record import read_record, require_record
from ..results.in_betweens import animated, has_in_betweens
from ..results.result_writing import SHAPE_KEY, key_name
from ..words.wording import told

if TYPE_CHECKING:
    from ...core import CanonicalForm, KeptStages
    from ...core.run.monitor import Cancelled
    from .likeness import Likeness


@dataclass(frozen=True)
class Request:
    """What to compute and where to write the result.

    Attributes
    ----------
    settings : Settings
        Options of the method.
    value : float
        Value of the shape key.
    step : {'FORM', 'PATCHES', 'FEATURES'}
        Last step: the form, the patches, or the feature points.
    feature_group : str
        Vertex group whose members are the feature points; empty to detect them or to use those of the settings.
    deformed : bool
        Use the evaluated mesh, with modifiers, pose and shape keys at the current frame, instead of the base mesh.
    unrefined : bool
        Of the evaluated mesh, leave out the modifiers that only refine it, so that a shape key can hold the result.
    new_object : bool
        Write the result to a new object.
    limb : str
        The only limb that a form straightens, as the core names it; empty for all.
    hausdorff : bool
        Also measure the Hausdorff distance.
    objects : {'TOUCHING', 'TOGETHER', 'EACH'}
        Which of several objects form one body: those that touch, all, or none.
    reference : callable, optional
        Returns the form that the result is aligned to, oriented as in the scene; may be slow, takes `cancelled` as in
        `canonical_form`, and does not access Blender's data.
    likeness : Likeness, optional
        The pose that the objects are put into, instead of computing a form.
    live : bool
        Whether to update a form only: sliders keep their values, and groups and colours stay if the patches are the
        same.
    keep : KeptStages, optional
        Stages kept from earlier runs on the objects: unchanged stages are not computed again.
    """

    settings: Settings = field(default_factory=Settings)
    _: KW_ONLY
    value: float = 1.0
    step: str = "FORM"
    feature_group: str = ""
    deformed: bool = False
    unrefined: bool = False
    new_object: bool = False
    limb: str = ""
    hausdorff: bool = False
    objects: str = "EACH"
    reference: Callable[[Cancelled | None], CanonicalForm] | None = None
    likeness: Likeness | None = None
    live: bool = False
    keep: KeptStages | None = None

    def points_for(self, obj: bpy.types.Object, reading: Reading) -> BodyPoints:
        """Return the feature points of an object: of the vertex group, if one is named, of the settings, or by hand.

        Parameters
        ----------
        obj : bpy.types.Object
            The object, in Object Mode.
        reading : Reading
            Its arrays.

        Returns
        -------
        BodyPoints
            Vertices of the reading; none if the object has no such group, or no points by hand.

        Raises
        ------
        CanonicalFormError
            If the group is too large, or modifiers keep no trace of its vertices.
        """
        given = self.settings.feature_points
        if self.feature_group:
            members = self._members(obj)
            return points_on(obj, reading, BodyPoints(members, [""] * len(members)))
        if given is not None:
            return BodyPoints(list(given), list(self.settings.feature_names or [""] * len(given)))
        return points_on(obj, reading, points_by_hand(obj.data))

    def _members(self, obj: bpy.types.Object) -> list[int]:
        """Return the members of the vertex group."""
        group = obj.vertex_groups.get(self.feature_group)
        members = [] if group is None else members_of(obj, group.name)
        if len(members) > MOST_FEATURES:
            raise CanonicalFormError(
                told(
                    "The vertex group {group} of {name} has {count:,} vertices. Choose one of {most} at most.",
                    group=self.feature_group,
                    name=obj.name,
                    count=len(members),
                    most=MOST_FEATURES,
                )
            )
        return members

    def require_points(self, name: str, chosen: Sequence[BodyPoints]) -> None:
        """Require feature points from the vertex group, if the request names one.

        Parameters
        ----------
        name : str
            Name of the object, or of the body that it is part of.
        chosen : sequence of BodyPoints
            Feature points on each object.

        Raises
        ------
        CanonicalFormError
            If there are none.
        """
        if self.feature_group and not any(each.vertices for each in chosen):
            raise CanonicalFormError(
                told(
                    "{name} has no vertex group {group} with vertices in it. Choose another "
                    "one, add feature points to it, or set Feature Points to Detected.",
                    name=name,
                    group=self.feature_group,
                )
            )

    def in_between_count(self, obj: bpy.types.Object) -> int:
        """Return the number of keys between pose and form that the run has to compute again.

        Parameters
        ----------
        obj : bpy.types.Object
            The object.

        Returns
        -------
        int
            Number of keys; 0 if the run leaves none on the mesh.

        Raises
        ------
        CanonicalFormError
            If the run would remove a form that is animated or has in-betweens, or one of another name that is animated.
        """
        mesh = obj.data
        gone = self.step != "FORM" and has_in_betweens(mesh)
        gone |= (self.step != "FORM" or self._is_another_key(mesh)) and animated(mesh) is not None
        if gone and not self.new_object:
            raise CanonicalFormError(
                told(
                    "This step would take the form of {name} away, and it is animated or has in-betweens. Clear first.",
                    name=obj.name,
                )
            )
        if self.new_object or self.step != "FORM" or not has_in_betweens(mesh):
            return 0
        return len(require_record(mesh).in_between_keys)

    def _is_another_key(self, mesh: bpy.types.Mesh) -> bool:
        """Return whether the form of an earlier run has another name than that of this run, which replaces it."""
        record, name = read_record(mesh), SHAPE_KEY if self.likeness is None else self.likeness.key
        return record is not None and key_name(record.report) != name
