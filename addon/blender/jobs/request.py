"""The request for a run: what is computed and where the result goes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import TYPE_CHECKING

import bpy

from ...core import CanonicalFormError, Settings
from ..objects.chosen_features import MOST_FEATURES, members_of
from ..records.record import require_record
from ..results.in_betweens import animated, has_in_betweens
from ..words.wording import told

if TYPE_CHECKING:
    from ...core import CanonicalForm, KeptStages
    from ...core.run.monitor import Cancelled
    from .likeness import Likeness


@dataclass(frozen=True)
class Request:
    """What is computed and where the result goes.

    Attributes
    ----------
    settings : Settings
        Options of the method.
    value : float
        Value of the shape key.
    step : {'FORM', 'PATCHES', 'FEATURES'}
        Last step: the form, the patches, or the feature points.
    feature_group : str
        Vertex group whose vertices are the feature points; empty to detect them, or for those of the settings.
    deformed : bool
        Compute on the evaluated mesh, with modifiers, pose and shape keys at the current frame, not on the base mesh.
    new_object : bool
        Put the result on a new object.
    hausdorff : bool
        Measure the Hausdorff distance too.
    objects : {'TOUCHING', 'TOGETHER', 'EACH'}
        Which of several objects are one body: those that touch, all, or none.
    reference : callable, optional
        Gives the form that the result is laid onto, turned as it stands in the scene; may take a while, takes
        `cancelled`, as in `canonical_form`, and touches no data of Blender's.
    likeness : Likeness, optional
        The pose that the objects are put into, in place of their form.
    live : bool
        Whether a form is only brought up to date: sliders stay where they are, groups and colours too where the patches
        are the same.
    keep : KeptStages, optional
        What earlier runs on the objects found: what has not changed is not computed again.
    """

    settings: Settings = field(default_factory=Settings)
    _: KW_ONLY
    value: float = 1.0
    step: str = "FORM"
    feature_group: str = ""
    deformed: bool = False
    new_object: bool = False
    hausdorff: bool = False
    objects: str = "EACH"
    reference: Callable[[Cancelled | None], CanonicalForm] | None = None
    likeness: Likeness | None = None
    live: bool = False
    keep: KeptStages | None = None

    def settings_for(self, obj: bpy.types.Object) -> Settings:
        """Return the settings for an object, with the feature points of the vertex group, if one is named.

        Parameters
        ----------
        obj : bpy.types.Object
            The object, in Object Mode.

        Returns
        -------
        Settings
            The settings; without feature points where the object has no such group.

        Raises
        ------
        CanonicalFormError
            If the group is too large, or the evaluated mesh is wanted.
        """
        if not self.feature_group:
            return self.settings
        if self.deformed:
            raise CanonicalFormError(told("Feature points from a group need the mesh itself. Set Mesh to Base Mesh."))
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
        return replace(self.settings, feature_points=members or None)

    def require_points(self, name: str, chosen: Sequence[Sequence[int]]) -> None:
        """Refuse to detect feature points where those of a vertex group are wanted.

        Parameters
        ----------
        name : str
            Name of the object, or of what it is together with others.
        chosen : sequence of sequence of int
            Feature points on each object.

        Raises
        ------
        CanonicalFormError
            If there are none.
        """
        if self.feature_group and not any(chosen):
            raise CanonicalFormError(
                told(
                    "{name} has no vertex group {group} with vertices in it. Choose another "
                    "one, add feature points to it, or set Feature Points to Detected.",
                    name=name,
                    group=self.feature_group,
                )
            )

    def in_between_count(self, obj: bpy.types.Object) -> int:
        """Return the number of keys between pose and form that the run has to compute again with the form.

        Parameters
        ----------
        obj : bpy.types.Object
            The object.

        Returns
        -------
        int
            Number of keys; 0 where the run leaves none on the mesh.

        Raises
        ------
        CanonicalFormError
            If the run would remove a form that is animated or has in-betweens.
        """
        mesh = obj.data
        if self.step != "FORM" and not self.new_object and (animated(mesh) is not None or has_in_betweens(mesh)):
            raise CanonicalFormError(
                told(
                    "This step would take the form of {name} away, and it is animated or has in-betweens. Clear first.",
                    name=obj.name,
                )
            )
        if self.new_object or self.step != "FORM" or not has_in_betweens(mesh):
            return 0
        return len(require_record(mesh).in_between_keys)
