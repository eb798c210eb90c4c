"""A mesh file kept open, with Blender or without: what it contains, what is computed on it, what is written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ..blender.jobs.likeness import Likeness
from ..core import CanonicalForm

if TYPE_CHECKING:
    from ..blender.records.form_report import FormReport
    from ..core.run.monitor import Progress

Reference = CanonicalForm | Likeness | None  # the form to align to, or the pose that is applied instead


class MeshInFile(NamedTuple):
    """One mesh object of an open file.

    Attributes
    ----------
    name : str
        Name of the object.
    vertices : int
        Number of its vertices.
    source : object
        What the open file knows it by.
    """

    name: str
    vertices: int
    source: Any = None


Body = Sequence[MeshInFile]  # one mesh, or several that are computed as one


class OpenFile(Protocol):
    """A file kept open, with Blender or without.

    Attributes
    ----------
    meshes : list of MeshInFile
        The meshes to be computed.
    """

    meshes: list[MeshInFile]

    def compute(
        self, body: Body, frame: int | None, reference: Reference, progress: Progress | None = None
    ) -> FormReport:
        """Compute a body at a frame, and keep the result for `write`; progress is reported as in `canonical_form`."""

    def write(self, target: Path) -> list[str]:
        """Write every result to a .blend file, the last one to other kinds; return warnings about what was left out."""

    def form(self, body: Body) -> CanonicalForm:
        """Compute the form of a body at the first frame, as a reference for others."""

    def pose(self, mesh: MeshInFile) -> Likeness:
        """Read the pose that a mesh is shown in, to be applied to others."""

    def warnings(self) -> list[str]:
        """Return warnings about the file, which apply to every result."""
