"""A file kept open without Blender: one mesh, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..blender.files.file_access import require_named
from ..blender.files.kinds_of_files import PLAIN
from ..blender.files.plain_files import read_plain, write_plain
from ..blender.files.polygon_mesh import fans
from ..blender.jobs.likeness import Likeness, PoseArrays
from ..blender.mesh_items.palette import colours_of
from ..blender.records.form_report import FormReport
from ..core import CanonicalForm, CanonicalFormError, PosedLike, canonical_form
from ..core.run.monitor import Progress
from .file_space import axes_of, in_file_space
from .open_files import Body, MeshInFile, Reference
from .wanted import Wanted

_NEEDS_BLENDER = "needs Blender as a module (pip install bpy)"


class PlainFile:
    """A .off, .obj or .ply file; the methods are those of `OpenFile`."""

    def __init__(self, path: Path, wanted: Wanted, names: Sequence[str]) -> None:
        if wanted.shown:
            raise CanonicalFormError(f"--mesh shown, --frame and --frames: this {_NEEDS_BLENDER}.")
        self._wanted = wanted
        self._turn = axes_of(path.suffix.lower()[1:]).T  # to the axes of a scene, as Blender reads the file
        self._mesh = read_plain(path)
        self._faces = fans(self._mesh.polygons)
        self._result: CanonicalForm | PosedLike | None = None
        require_named(path, names, [path.stem])
        self.meshes = [MeshInFile(path.stem, len(self._mesh.vertices))]

    def compute(
        self, body: Body, frame: int | None, reference: Reference, progress: Progress | None = None
    ) -> FormReport:
        """Compute the form or the pose."""
        if f".{self._wanted.format}" not in PLAIN:
            kinds = ", ".join(kind[1:] for kind in PLAIN)
            raise CanonicalFormError(f"--format {self._wanted.format} {_NEEDS_BLENDER}. Without it, choose {kinds}.")
        vertices, settings = self._mesh.vertices @ self._turn, self._wanted.settings
        hausdorff = "hausdorff" in self._wanted.measures
        if isinstance(reference, Likeness):
            posed, _ = reference.posed(vertices, self._faces, settings, progress=progress)
            report = FormReport.of(posed, vertices, self._faces, settings, hausdorff=hausdorff)
            report.like = reference.report(posed)
            self._result = posed
            return report
        form = canonical_form(vertices, self._faces, settings, reference=reference, progress=progress)
        self._result = form
        return FormReport.of(form, vertices, self._faces, settings, hausdorff=hausdorff)

    def write(self, target: Path) -> list[str]:
        """Write the result with what the file carried."""
        found = self._result
        assert found is not None
        placement = np.eye(4)
        placement[:3, :3] = self._turn.T
        mesh = self._mesh._replace(vertices=in_file_space(found.vertices @ self._turn.T, placement, self._wanted))
        field = self._wanted.colours
        if field != "none":
            mesh = mesh._replace(colours=colours_of(found.adf, found.patches, self._faces).named(field))
        if field == "patches":
            mesh = mesh._replace(patches=found.patches)
        write_plain(target, mesh, self._wanted.mark)
        return []

    def form(self, body: Body) -> CanonicalForm:
        """Compute the form of the mesh."""
        return canonical_form(self._mesh.vertices @ self._turn, self._faces, self._wanted.settings)

    def pose(self, mesh: MeshInFile) -> Likeness:
        """Return the pose of the mesh."""
        vertices = self._mesh.vertices @ self._turn
        arrays = PoseArrays(vertices, self._faces, vertices)
        return Likeness("OBJECT", mesh.name, arrays, self._wanted.side)

    def warnings(self) -> list[str]:
        """Return no warnings: there are no scripts that could have been left off."""
        return []
