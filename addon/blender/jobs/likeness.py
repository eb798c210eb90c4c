"""The pose of another mesh or of a mannequin, to be applied to a mesh, without Blender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...core.numerics.arrays import FloatArray, IntArray
from ..records.form_report import LikeReport
from ..results.match_values import MatchValues

if TYPE_CHECKING:
    from ...core import KeptStages, PosedLike, Settings, Stance
    from ...core.run.monitor import Cancelled, Progress
    from ..objects.mesh_reading import Bones

MANNEQUINS = {"T": "T-Pose", "A": "A-Pose"}  # with the names of their shape keys
_LIKE = "Like {}"
_LONGEST = 63  # bytes of a name in Blender


class PoseArrays(NamedTuple):
    """A mesh that provides a pose.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Positions used for matching.
    faces : (m, 3) ndarray of int
        Triangles.
    pose : (n, 3) ndarray of float
        Positions in the pose, oriented as in the scene.
    """

    vertices: FloatArray
    faces: IntArray
    pose: FloatArray


@dataclass(frozen=True, eq=False)
class Likeness:
    """A pose to be applied to a mesh.

    Attributes
    ----------
    pose : {'OBJECT', 'T', 'A'}
        Source of the pose: a mesh, or a mannequin in T-pose or A-pose.
    name : str
        Name of the mesh.
    reference : PoseArrays or None
        The mesh; None for a mannequin.
    side : int
        Which way to match: -1 for the most likely, or its index.
    anyway : bool
        Whether to keep a T-pose or an A-pose that is unlikely to be right.
    """

    pose: str
    name: str = ""
    reference: PoseArrays | None = None
    side: int = -1
    anyway: bool = False

    @property
    def key(self) -> str:
        """Name of the shape key that holds the result, truncated to the longest name in Blender."""
        name = MANNEQUINS.get(self.pose, _LIKE.format(self.name))
        return name.encode()[:_LONGEST].decode(errors="ignore")

    @property
    def by_bones(self) -> bool:
        """Whether a rig gives the pose by itself: a T-pose or an A-pose, unless a way to match is asked for."""
        return self.pose in MANNEQUINS and self.side < 0

    def report(self, found: PosedLike | Stance) -> LikeReport:
        """Report the source of the pose and the confidence of the match.

        Parameters
        ----------
        found : PosedLike or Stance
            The mesh in that pose.

        Returns
        -------
        LikeReport
            The report.
        """
        from ...core import Stance

        if isinstance(found, Stance):
            return LikeReport(self.pose, self.name, self.key, 0, [], 1.0, "bones")
        confidence = round(float(found.match.confidence.mean()), 3)
        bones = {name: round(sure, 3) for name, sure in found.bones.items()}
        sides = found.match.sides
        return LikeReport(self.pose, self.name, self.key, max(self.side, 0), sides, confidence, bones=bones)

    def stance(self, rest: FloatArray, faces: IntArray, bones: Bones) -> Stance | None:
        """Put a rigged mesh into the stance by its own bones.

        Parameters
        ----------
        rest : (n, 3) ndarray of float
            Positions in the rest pose, in world space.
        faces : (m, 3) ndarray of int
            Triangles.
        bones : Bones
            The bones of all vertices.

        Returns
        -------
        Stance or None
            The mesh in that pose, in world space; None if its bones do not tell arms and legs.
        """
        from ...core import InvalidMeshError, stance_by_bones

        try:
            return stance_by_bones(rest, faces, bones.skeleton, bones.weights, self.pose)
        except InvalidMeshError as error:
            if error.kind != "stance_limbs":
                raise
            return None

    def posed(
        self,
        vertices: FloatArray,
        faces: IntArray,
        settings: Settings,
        rest: FloatArray | None = None,
        progress: Progress | None = None,
        cancelled: Cancelled | None = None,
        keep: KeptStages | None = None,
    ) -> tuple[PosedLike, MatchValues]:
        """Put a mesh into the pose; may run in any thread.

        Parameters
        ----------
        vertices : (n, 3) ndarray of float
            Positions, oriented as in the scene.
        faces : (m, 3) ndarray of int
            Triangles.
        settings : Settings
            Options for both forms.
        rest : (n, 3) ndarray of float, optional
            Positions in the rest pose of a rig.
        progress, cancelled : callable, optional
            As in `pose_like`.
        keep : KeptStages, optional
            Results of earlier runs on this mesh, of which a T-pose or an A-pose the other way round is made.

        Returns
        -------
        found : PosedLike
            The mesh in that pose, oriented for the scene.
        carried : MatchValues
            Values that show the match.

        Raises
        ------
        CanonicalFormError
            As in `pose_like`.
        """
        from ...core import mannequin, pose_like, stance_by_match, transferred
        from ..mesh_items.palette import places

        side: str | int = "auto" if self.side < 0 else self.side
        if self.reference is None:
            here = mannequin()[0]
            found = stance_by_match(
                vertices,
                faces,
                settings,
                pose=self.pose,
                side=side,
                anyway=self.anyway,
                rest=rest,
                keep=keep,
                progress=progress,
                cancelled=cancelled,
            )
        else:
            here, triangles, pose = self.reference
            found = pose_like(
                vertices,
                faces,
                here,
                triangles,
                settings,
                side=side,
                reference_pose=pose,
                rest=rest,
                progress=progress,
                cancelled=cancelled,
            )
        colours = transferred(found.match, places(here))
        return found, MatchValues(found.match.confidence, np.append(colours, np.ones((len(colours), 1)), axis=1))
