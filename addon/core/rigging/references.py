"""The bodies that lend a skeleton, unfolded: the mannequin as it is, and in other proportions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..matching.unfolded import Unfolded, unfolded
from ..method_api.catalogue import method_named
from ..method_api.settings import Settings
from ..method_api.surface_features import detected
from ..numerics.arrays import IntArray
from ..run.monitor import Monitor
from ..symmetry.limb_names import names_by_bones
from .proportions import BUILDS, reshaped, scales_of
from .reference_rig import ReferenceRig


class Reference(NamedTuple):
    """A body that lends its skeleton.

    Attributes
    ----------
    rig : ReferenceRig
        Its skeleton, on the working vertices.
    body : Unfolded
        Its form, and what a match compares.
    whole : ReferenceRig
        The same skeleton on all vertices of that body.
    """

    rig: ReferenceRig
    body: Unfolded
    whole: ReferenceRig


def adult(rig: ReferenceRig, body: Unfolded, vertices: IntArray) -> Reference:
    """Take a reference as it is, on its working vertices.

    `rig`: on all its vertices; `body`: the part that lends the skeleton, unfolded; `vertices` (n',): of that part.
    """
    whole = rig.at(vertices, body.found.whole_faces)
    own = whole.at(body.found.surface.kept, body.found.surface.faces)
    return Reference(own, _named(own, body), whole)


def other_builds(adult: Reference, settings: Settings, monitor: Monitor) -> list[Reference]:
    """Unfold the mannequin in all other builds: of the adult's working vertices, so that triangles are the same.

    `settings`: of their forms.
    """
    found = []
    for build in BUILDS.values():
        scales = scales_of(adult.rig, build)
        rig = reshaped(adult.rig, scales)
        found.append(Reference(rig, _named(rig, _unfolded(rig, settings, monitor)), reshaped(adult.whole, scales)))
    return found


def _named(rig: ReferenceRig, body: Unfolded) -> Unfolded:
    """Name the feature points of a human reference by the bones that move them."""
    if not rig.is_human:
        return body
    names = names_by_bones([rig.skeleton.names[bone] for bone in rig.weights[body.features].argmax(axis=1)])
    return body._replace(limbs=body.limbs._replace(named=tuple(names)))


def unfolded_reference(rig: ReferenceRig, settings: Settings, monitor: Monitor) -> Reference:
    """Unfold a rigged body that is one closed surface. `settings`: of its form."""
    return adult(rig, _unfolded(rig, settings, monitor), np.arange(len(rig.vertices)))


def _unfolded(rig: ReferenceRig, settings: Settings, monitor: Monitor) -> Unfolded:
    """Unfold a closed surface."""
    quiet = Monitor(cancelled=monitor.is_cancelled)  # what it says is about no mesh of the user
    method = method_named(settings.method)
    settings = method.settings(settings)
    found = detected(rig.vertices, rig.faces, None, settings, quiet)
    form = method.unfold(found, settings, quiet).of_unit_area(found.whole_faces)
    return unfolded(found, form.points, quiet)
