"""Results of the entry points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .numerics.arrays import BoolArray, FloatArray, IntArray
from .run.messages import Message
from .run.summaries import Summarised

if TYPE_CHECKING:
    from .fused.on_given import Parted
    from .matching.seam_sides import SeamSides
    from .rigging.skeleton import BoneMotions, Skeleton
    from .symmetry.limbs import BodyLimbs


@dataclass(frozen=True, eq=False, repr=False)
class FeaturePatches(Summarised):
    """Feature points and patches of a mesh.

    Attributes
    ----------
    feature_points : (k,) ndarray of int
        Vertices, in an order that does not depend on the pose: head, tail, limbs in pairs, left before right; or as
        given. Piece by piece, those of the largest first.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to; -1 for vertices of no face.
    adf : (n,) ndarray of float
        Auto Diffusion Function of each piece scaled to unit area; 0 at vertices of no face.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of Message
        Sentences for the user.
    bodies : list of BodyLimbs
        The limbs identified among the feature points of each body; a form of this mesh needs them to be a reference.
    eigenvalues : (K,) ndarray of float
        λ_1 ≤ … ≤ λ_K of the Laplacian of the largest body, scaled to unit area.
    feature_names : list of str
        What the feature points are: 'head', 'left_hand', … as in `Settings`, or ''.
    """

    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    timings: dict[str, float]
    warnings: list[Message]
    bodies: list[BodyLimbs] = field(default_factory=list)
    eigenvalues: FloatArray = field(default_factory=lambda: np.empty(0))
    feature_names: list[str] = field(default_factory=list)


@dataclass(frozen=True, eq=False, repr=False)
class CanonicalForm(Summarised):
    """The canonical form of a mesh and intermediate results.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The form, with the area of the input and rigidly aligned to it, each connected piece by itself. Vertices of no
        face keep their positions.
    faces : (m', 3) ndarray of int
        The triangles of the form: those given, repaired where the warnings say so.
    feature_points : (k,) ndarray of int
        Vertices, in an order that does not depend on the pose: head, tail, limbs in pairs, left before right; or as
        given. Piece by piece, those of the largest first.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to; -1 for vertices of no face.
    adf : (n,) ndarray of float
        Auto Diffusion Function of each piece scaled to unit area; 0 at vertices of no face.
    stress : (s + 1,) ndarray of float
        Stress before each of the s steps and after the last, on the surface scaled to unit area; summed over the
        pieces. Empty for a method whose form is not the minimum of one stress, such as the default.
    pair_count : int
        Entries of the distance matrices that the method uses, counted as the paper does: Σ p² over the patches and
        the feature points; 0 where it uses none.
    pair_reduction : float
        ``1 - pair_count / n²``; 0 without such pairs.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of Message
        Sentences for the user.
    asymmetry : float
        Root mean square deviation of the form from its mirror image, in units of sqrt(area); of several bodies, the
        largest. nan where no left and right was found.
    bodies : list of BodyLimbs
        The limbs identified among the feature points of each body.
    bends : (k, 2) ndarray of float
        Degrees by which each limb is bent at its joint, in the input and in the form; nan where a patch is no limb, but
        a head or a trunk.
    contacts : (n,) ndarray of bool
        Vertices at which the mesh was parted for the form; empty if it was not.
    parted : Parted, optional
        The mesh that was parted for the form, and its form.
    posed : (n, 3) ndarray of float
        The vertices as given; empty where they are not known.
    eigenvalues : (K,) ndarray of float
        λ_1 ≤ … ≤ λ_K of the Laplacian of the largest body, scaled to unit area: a shape descriptor that no pose
        changes.
    feature_names : list of str
        As in `FeaturePatches`.
    """

    vertices: FloatArray
    faces: IntArray
    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    stress: FloatArray
    pair_count: int
    pair_reduction: float
    timings: dict[str, float]
    warnings: list[Message]
    asymmetry: float = float("nan")
    bodies: list[BodyLimbs] = field(default_factory=list)
    bends: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    contacts: BoolArray = field(default_factory=lambda: np.empty(0, dtype=bool))
    parted: Parted | None = None
    posed: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    eigenvalues: FloatArray = field(default_factory=lambda: np.empty(0))
    feature_names: list[str] = field(default_factory=list)


class MatchedSeams(NamedTuple):
    """The seams of two meshes that are matched, where borders coincide.

    Attributes
    ----------
    joined : (n,) ndarray of int
        The vertex of this mesh that stands for each: itself, or the first at its place.
    other_joined : (n',) ndarray of int
        The same for the other mesh.
    sides : SeamSides
        Copies of one place of this mesh that lie on different sides of a seam of the other, and the point of each on
        its own side: where values differ from side to side, as weights do at lips that are closed, each gets its own.
    """

    joined: IntArray
    other_joined: IntArray
    sides: SeamSides


@dataclass(frozen=True, eq=False, repr=False)
class Match(Summarised):
    """For every vertex of a mesh, the corresponding point of another.

    Attributes
    ----------
    vertices : (n,) ndarray of int
        The nearest vertex of the other mesh; -1 where there is no match.
    faces : (n,) ndarray of int
        The triangle that the point lies on, in `other_faces`; -1 where there is no match.
    weights : (n, 3) ndarray of float
        Its barycentric coordinates there; 0 where there is no match.
    confidence : (n,) ndarray of float
        Confidence of each point, 0 to 1.
    sides : list of float
        Scores, without unit, of the possible matches, which differ in left and right or front and back; the likeliest
        first. Lower is better; among the first, strain, and left and right of both surfaces, count too. Of several
        bodies, those of the largest.
    other_faces : (m', 3) ndarray of int
        Triangles of the other mesh: those given, repaired where `other_warnings` says so. Where borders coincide, each
        has its own vertices.
    other_count : int
        Number n' of vertices of the other mesh.
    timings : dict of str to float
        Seconds by stage, both meshes together.
    warnings : list of Message
        Sentences for the user, about this mesh and the match.
    other_warnings : list of Message
        Sentences about the other mesh.
    seams : MatchedSeams, optional
        The vertices that were treated as one; None for none.
    """

    vertices: IntArray
    faces: IntArray
    weights: FloatArray
    confidence: FloatArray
    sides: list[float]
    other_faces: IntArray
    other_count: int
    timings: dict[str, float]
    warnings: list[Message]
    other_warnings: list[Message]
    seams: MatchedSeams | None = None


@dataclass(frozen=True, eq=False, repr=False)
class PosedLike(Summarised):
    """A mesh in the pose of another.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The mesh in that pose, in its own size, around its own centre, oriented as the other.
    faces : (m', 3) ndarray of int
        Its triangles: those given, repaired where the warnings say so.
    feature_points : (k,) ndarray of int
        As in `CanonicalForm`.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to; -1 for vertices of no face.
    adf : (n,) ndarray of float
        Auto Diffusion Function of each piece scaled to unit area; 0 at vertices of no face.
    match : Match
        The match with the other mesh.
    edge_distortion : float
        Median relative change of edge length.
    timings : dict of str to float
        Seconds by stage, both meshes together.
    warnings : list of Message
        Sentences for the user.
    bones : dict of str to float
        How far the skin of each fitted bone that has some follows it, 0 to 1; empty where no skeleton was fitted.
    contacts, parted
        As in `CanonicalForm`.
    feature_names : list of str
        As in `FeaturePatches`.
    """

    vertices: FloatArray
    faces: IntArray
    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    match: Match
    edge_distortion: float
    timings: dict[str, float]
    warnings: list[Message]
    bones: dict[str, float] = field(default_factory=dict)
    contacts: BoolArray = field(default_factory=lambda: np.empty(0, dtype=bool))
    parted: Parted | None = None
    feature_names: list[str] = field(default_factory=list)


@dataclass(frozen=True, eq=False, repr=False)
class Stance(Summarised):
    """A rigged mesh in a T-pose or an A-pose.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The mesh in that pose, around its own centre, facing -Y, its left at +X, Z up.
    faces : (m, 3) ndarray of int
        Its triangles.
    feature_points : (0,) ndarray of int
        None: bones need no feature points.
    patches : (n,) ndarray of int
        -1.
    adf : (n,) ndarray of float
        0.
    bones : list of str
        Names of the bones that were turned: of each arm and leg, the left one first, from its root to its end.
    edge_distortion : float
        Median relative change of edge length.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of Message
        Sentences for the user.
    feature_names : list of str
        None.
    """

    vertices: FloatArray
    faces: IntArray
    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    bones: list[str]
    edge_distortion: float
    timings: dict[str, float]
    warnings: list[Message]
    feature_names: list[str] = field(default_factory=list)


@dataclass(frozen=True, eq=False, repr=False)
class Rigged(Summarised):
    """A skeleton for a mesh, with weights.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The mesh with its skeleton at rest: as it was given, or in the pose that was asked for.
    skeleton : Skeleton
        The b bones at rest, in the unit and place of the mesh.
    to_given : BoneMotions
        How the bones move from rest to where they lie in the mesh as it was given.
    bends : (b, 3) ndarray of float
        Unit vector across each bone: the axis about which it bends, such as that of a knee. The roll of a bone follows.
    weights : (n, b) ndarray of float
        How far each vertex follows each bone, at most four; rows sum to 1, of vertices of no face too.
    confidence : (b,) ndarray of float
        How well each bone explains the skin that it moves, 0 to 1.
    match : Match
        The match with the mesh that has lent the skeleton; its `sides` are the costs of the ways to face.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of Message
        Sentences for the user.
    """

    vertices: FloatArray
    skeleton: Skeleton
    to_given: BoneMotions
    bends: FloatArray
    weights: FloatArray
    confidence: FloatArray
    match: Match
    timings: dict[str, float]
    warnings: list[Message]


Shaped = CanonicalForm | PosedLike | Stance  # results with a shape of their own
AnyResult = FeaturePatches | Shaped
