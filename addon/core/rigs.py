"""Entry point for a rig: a skeleton with weights for a body in any pose, from a mannequin or a rigged mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .assembly.gathering import gathered
from .mannequins import mannequin
from .matches import UNFOLDED, UnfoldedPair, on_meshes, unfolded_pair
from .matching.point_map import PointMap
from .matching.sides import index_of_side, require_side
from .matching.unfolded import Unfolded
from .mesh.closest_points import closest_points
from .mesh.geometry import surface_area
from .method_api.settings import Settings
from .numerics.arrays import FloatArray
from .results import Match, Rigged
from .rigging.candidates import Candidate, candidates
from .rigging.fitted_rig import bend_axes, filled_in, settled_turns, with_equal_sides
from .rigging.reference_rig import ReferenceRig, mannequin_rig
from .rigging.references import adult, other_builds
from .rigging.skeleton import Skeleton
from .rigging.stance_gate import is_doubtful, refusal
from .run.kept_stages import KeptStages
from .run.monitor import Cancelled, Monitor, Progress

_FACING = {"Ways to face": 1}  # stages
_TRUSTED = 0.03  # of the size: residual of skin that hardly follows the skeleton
_FORGOTTEN = 0.01  # weights below which a bone does not hold a vertex


class FittedMannequin(NamedTuple):
    """A body with the mannequin's skeleton in every way in which it may face.

    Attributes
    ----------
    pair : UnfoldedPair
        The mesh and the mannequin.
    rig : ReferenceRig
        That of the whole mannequin.
    found : list of Candidate
        The skeletons of the largest body, the likeliest first.
    """

    pair: UnfoldedPair
    rig: ReferenceRig
    found: list[Candidate]

    @property
    def body(self) -> Unfolded:
        """The largest body of the mesh."""
        return self.pair.surfaces[self.pair.pairs[0][0]]

    @property
    def share(self) -> float:
        """Share of the mesh's area that this body has."""
        areas = [surface_area(body.points, body.faces) for body in self.pair.bodies.bodies]
        return areas[self.pair.pairs[0][0]] / sum(areas)

    def match(self, chosen: Candidate, monitor: Monitor) -> Match:
        """Express a candidate as a match with the whole mannequin, an adult, whichever build has lent the skeleton.

        Parameters
        ----------
        chosen : Candidate
            One of those found.
        monitor : Monitor
            Of the whole run.

        Returns
        -------
        Match
            The match; its `sides` are the costs of all candidates.
        """
        fit, own, surface = chosen.fit, chosen.reference, self.body.found.surface
        on_build = closest_points(own.rig.vertices, own.rig.faces, fit.at, monitor)
        there = on_build.on(self.rig.vertices[own.kept], own.rig.faces)  # all builds have the adult's triangles
        points = closest_points(self.rig.vertices, self.rig.faces, surface.prolong(there), monitor)
        whole = PointMap(points, np.clip(surface.prolong(fit.sure), 0.0, 1.0), chosen.cost)
        pair, costs = self.pair, [each.cost for each in self.found]
        return on_meshes(pair.bodies, pair.others, pair.pairs[:1], [whole], costs, monitor, pair.other_warnings)


def fitted_mannequin(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings,
    kept: KeptStages,
    monitor: Monitor,
    share: float,
    *,
    rest: ArrayLike | None = None,
) -> FittedMannequin:
    """Fit the mannequin's skeleton to the largest body of a mesh.

    Parameters
    ----------
    vertices, faces, settings, rest
        As in `rig`.
    kept : KeptStages
        Results of earlier runs.
    monitor : Monitor
        Of the whole run.
    share : float
        Share of the whole run that this takes.

    Returns
    -------
    FittedMannequin
        The skeletons.

    Raises
    ------
    CanonicalFormError
        As in `match`.
    """
    whole = mannequin_rig(*mannequin())

    def unfold() -> UnfoldedPair:
        return unfolded_pair(vertices, faces, whole.vertices, whole.faces, settings, monitor, share, rest=rest)

    pair = kept.take("Forms", [vertices, faces, repr(settings), rest], unfold, monitor.warnings)
    here, there = pair.pairs[0]

    def look() -> list[Candidate]:
        own = monitor.piece(UNFOLDED * share, share, _FACING)
        with own.stage("Ways to face"):
            reference = adult(whole, pair.other_surfaces[there])
            return candidates(pair.surfaces[here], reference, lambda: other_builds(reference, settings, own), own)

    return FittedMannequin(pair, whole, kept.take("Ways to face", [pair], look, monitor.warnings))


def rig(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    *,
    side: str | int = "auto",
    equal: bool = True,
    anyway: bool = False,
    rest: ArrayLike | None = None,
    keep: KeptStages | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> Rigged:
    """Give a human body in any pose a skeleton, with weights for its skin.

    The skeleton is the mannequin's, in Rigify's names, as `stance_by_match` fits it, where the body stands, sits or
    lies. Weights are those of the matching points, and flow over the skin to where the match is not trusted.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    settings : Settings, optional
        Options of the forms; chosen feature points refer to this mesh.
    side : str or int
        "auto", or the index of one of the ways to face, 0 for the likeliest.
    equal : bool
        Make bones of the left and the right side equally long.
    anyway : bool
        Return a rig although it is unlikely to be right.
    rest : (n, 3) array_like of float, optional
        Positions in the rest pose of another rig, as in `canonical_form`.
    keep : KeptStages, optional
        Results of earlier runs on this mesh, also of `stance_by_match`.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.

    Returns
    -------
    Rigged
        The skeleton in the pose of the mesh, and its weights.

    Raises
    ------
    CanonicalFormError
        As in `match`; an InvalidMeshError, too, where the skeleton is unlikely to be right and `anyway` is not set.

    Examples
    --------
    >>> from addon.core import mannequin
    >>> vertices, faces = mannequin()
    >>> rig(vertices, faces).weights.shape  # doctest: +SKIP
    (30346, 22)

    References
    ----------
    Pellegrini, Schindler and Nardi, "A Generalization of the ICP Algorithm for Articulated Bodies", 2008; Abdrashitov
    and others, "Robust Skin Weights Transfer via Weight Inpainting", 2023, doi:10.1145/3610543.3626180;
    docs/method.md lists what is original to this project.
    """
    require_side(side)
    monitor = Monitor(progress, cancelled)
    fitted = fitted_mannequin(vertices, faces, settings or Settings(), keep or KeptStages(), monitor, 1.0, rest=rest)
    chosen = fitted.found[index_of_side(side, len(fitted.found))]
    error = refusal(chosen, fitted.share)
    if error is not None:
        if not anyway:
            raise error
        monitor.warn("stance_doubtful")
    elif side == "auto" and is_doubtful(fitted.found):
        monitor.warn("match_sides")
    return _rigged(fitted, chosen, equal, monitor)


def _rigged(fitted: FittedMannequin, chosen: Candidate, equal: bool, monitor: Monitor) -> Rigged:
    """Gather the rig of a mesh, in its own unit."""
    own, fit, reference = fitted.body.found, chosen.fit, chosen.reference.rig
    trust = fit.sure * np.exp(-((fit.residual / _TRUSTED) ** 2))
    bones = fit.bones._replace(turns=settled_turns(reference, fit.bones))
    if equal:
        bones = with_equal_sides(reference, bones)
    skin = own.mass[:, None] * fit.weights
    weights = filled_in(fit.weights, trust, own.stiffness, own.mass)
    skeleton = Skeleton(
        list(reference.skeleton.names),
        reference.skeleton.parents,
        bones.heads * own.unit + own.centre,
        bones.tails * own.unit + own.centre,
    )
    return Rigged(
        skeleton,
        bend_axes(reference, bones),
        _on_all(fitted, weights),
        trust @ skin / np.maximum(skin.sum(axis=0), 1e-30),
        fitted.match(chosen, monitor),
        monitor.timings,
        monitor.warnings,
    )


def _on_all(fitted: FittedMannequin, weights: FloatArray) -> FloatArray:
    """Carry weights of the working vertices to all of the mesh; vertices of other bodies take those of the nearest."""
    from scipy.spatial import cKDTree

    bodies, here = fitted.pair.bodies, fitted.pair.pairs[0][0]
    values = [np.zeros((len(body.vertices), weights.shape[1])) for body in bodies.bodies]
    values[here] = fitted.body.found.surface.prolong(weights)
    whole = gathered(bodies, values, np.zeros((len(bodies.vertices), weights.shape[1])))
    held = whole.any(axis=1)
    whole[~held] = whole[held][cKDTree(bodies.vertices[held]).query(bodies.vertices[~held])[1]]
    whole[whole < _FORGOTTEN] = 0.0
    return np.asarray(whole / whole.sum(axis=1, keepdims=True))
