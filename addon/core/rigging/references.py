"""The bodies that lend a skeleton, unfolded: the mannequin as it is, and in other proportions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..matching.unfolded import Unfolded, unfolded
from ..mesh.geometry import surface_area
from ..method_api.catalogue import method_named
from ..method_api.settings import Settings
from ..method_api.surface_features import detected
from ..numerics.arrays import IntArray
from ..run.monitor import Monitor
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
    kept : (c,) ndarray of int
        Which vertices of the adult its working vertices are.
    """

    rig: ReferenceRig
    body: Unfolded
    kept: IntArray


def adult(rig: ReferenceRig, body: Unfolded) -> Reference:
    """Take a reference as it is, on its working vertices. `rig`: on all its vertices; `body`: it, unfolded."""
    kept = body.found.surface.kept
    return Reference(rig.at(kept, body.found.surface.faces), body, kept)


def other_builds(adult: Reference, settings: Settings, monitor: Monitor) -> list[Reference]:
    """Unfold the mannequin in all other builds: of the adult's working vertices, so that triangles are the same.

    `settings`: of their forms.
    """
    rigs = [reshaped(adult.rig, scales_of(adult.rig, build)) for build in BUILDS.values()]
    return [Reference(rig, _unfolded(rig, settings, monitor), adult.kept) for rig in rigs]


def _unfolded(rig: ReferenceRig, settings: Settings, monitor: Monitor) -> Unfolded:
    """Unfold a closed surface of working size."""
    quiet = Monitor(cancelled=monitor.is_cancelled)  # what it says is about no mesh of the user
    method = method_named(settings.method)
    settings = method.settings(settings)
    found = detected(rig.vertices, rig.faces, None, settings, quiet)
    form = method.unfold(found, settings, quiet).points
    return unfolded(found, form / np.sqrt(surface_area(form, found.whole_faces)), quiet)
