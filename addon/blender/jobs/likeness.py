"""A pose to take, apart from Blender: that of another mesh, or a mannequin's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...core.numerics.arrays import FloatArray, IntArray
from ..records.form_report import LikeReport
from ..results.carried import Carried

if TYPE_CHECKING:
    from ...core import PosedLike, Settings
    from ...core.run.monitor import Cancelled, Progress

MANNEQUINS = {"T": "T-Pose", "A": "A-Pose"}  # and what their keys are called
_LIKE = "Like {}"
_LONGEST = 63  # bytes of a name in Blender


class PoseArrays(NamedTuple):
    """A mesh whose pose is taken.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Positions by which it is matched.
    faces : (m, 3) ndarray of int
        Triangles.
    pose : (n, 3) ndarray of float
        Positions in the pose that is taken, turned as they stand in the scene.
    """

    vertices: FloatArray
    faces: IntArray
    pose: FloatArray


@dataclass(frozen=True, eq=False)
class Likeness:
    """A pose to take.

    Attributes
    ----------
    pose : {'OBJECT', 'T', 'A'}
        Whose pose it is: that of a mesh, or of a mannequin.
    name : str
        Name of the mesh.
    reference : PoseArrays or None
        The mesh; None for a mannequin.
    side : int
        Which way to match: -1 for the likeliest, or its number.
    """

    pose: str
    name: str = ""
    reference: PoseArrays | None = None
    side: int = -1

    @property
    def key(self) -> str:
        """Name of the shape key that holds the result, cut to what Blender keeps of it."""
        name = MANNEQUINS.get(self.pose, _LIKE.format(self.name))
        return name.encode()[:_LONGEST].decode(errors="ignore")

    def report(self, found: PosedLike) -> LikeReport:
        """Report whose pose was taken, and how sure the match is.

        Parameters
        ----------
        found : PosedLike
            The mesh in that pose.

        Returns
        -------
        LikeReport
            The report.
        """
        confidence = round(float(found.match.confidence.mean()), 3)
        return LikeReport(self.pose, self.name, self.key, max(self.side, 0), found.match.sides, confidence)

    def posed(
        self,
        vertices: FloatArray,
        faces: IntArray,
        settings: Settings,
        progress: Progress | None = None,
        cancelled: Cancelled | None = None,
    ) -> tuple[PosedLike, Carried]:
        """Pose a mesh like that; may run in any thread.

        Parameters
        ----------
        vertices : (n, 3) ndarray of float
            Positions, turned as they stand in the scene.
        faces : (m, 3) ndarray of int
            Triangles.
        settings : Settings
            Options of the forms of both.
        progress, cancelled : callable, optional
            As in `pose_like`.

        Returns
        -------
        found : PosedLike
            The mesh in that pose, turned as it is to stand in the scene.
        carried : Carried
            What shows the match.

        Raises
        ------
        CanonicalFormError
            As in `pose_like`.
        """
        from ...core import pose_like, transferred
        from ..mesh_items.palette import places

        here, triangles, pose = self.reference or _mannequin(self.pose)
        found = pose_like(
            vertices,
            faces,
            here,
            triangles,
            settings,
            side="auto" if self.side < 0 else self.side,
            reference_pose=pose,
            progress=progress,
            cancelled=cancelled,
        )
        colours = transferred(found.match, places(here))
        return found, Carried(found.match.confidence, np.append(colours, np.ones((len(colours), 1)), axis=1))


def _mannequin(pose: str) -> PoseArrays:
    """Make a mannequin: matched in its T-pose, which tells its front from its back best."""
    from ...core import mannequin
    from ...core.mannequins import A_POSE, T_POSE

    vertices, faces = mannequin(T_POSE)
    return PoseArrays(vertices, faces, vertices if pose == "T" else mannequin(A_POSE)[0])
