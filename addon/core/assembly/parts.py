"""The connected surfaces of a mesh: each is worked on by itself, and the results come together on all vertices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..mesh.connectivity import component_labels
from ..mesh.geometry import surface_area
from ..mesh.repair import has_area, mended
from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidMeshError, InvalidSettingsError
from ..run.monitor import Monitor

_MOST = 500  # parts; more are loose faces, or cards of hair and leaves, whose patches nobody could use
_SAID = 5  # warnings about parts that are told one by one
_ALIKE = 1e-6  # share of the whole area within which two parts count as equally large


@dataclass(frozen=True, eq=False)
class Part:
    """One connected surface.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        Its vertices among those of the mesh, rising.
    points : (p, 3) ndarray of float
        Their positions.
    faces : (q, 3) ndarray of int
        Its triangles; corners index `vertices`.
    """

    vertices: IntArray
    points: FloatArray
    faces: IntArray


@dataclass(frozen=True, eq=False)
class Parts:
    """A mesh as connected surfaces.

    Attributes
    ----------
    parts : list of Part
        The surfaces, largest area first.
    vertices : (n, 3) ndarray of float
        Positions of all vertices, as given.
    faces : (m, 3) ndarray of int
        Triangles of all parts, as corners of the mesh.
    mended : list of str
        What was different from the mesh as given, as sentences for the user.
    apart : list of str
        What becomes of loose parts and of vertices without a face in a form, likewise.
    """

    parts: list[Part]
    vertices: FloatArray
    faces: IntArray
    mended: list[str]
    apart: list[str]
    _stands_for: IntArray

    def together(self, values: Sequence[np.ndarray], others: np.ndarray) -> np.ndarray:
        """Put values of the parts together.

        Parameters
        ----------
        values : sequence of (p, ...) ndarray
            Values on the vertices of each part.
        others : (n, ...) ndarray
            Values of vertices that are in no part.

        Returns
        -------
        (n, ...) ndarray
            Values on all vertices; those that were taken as one have the same.
        """
        whole = others.copy()
        for part, each in zip(self.parts, values, strict=True):
            whole[part.vertices] = each
        copies = np.flatnonzero(self._stands_for != np.arange(len(whole)))
        whole[copies] = whole[self._stands_for[copies]]
        return whole

    def placed(self, chosen: ArrayLike) -> list[tuple[IntArray, IntArray]]:
        """Find vertices of the mesh in the parts.

        Parameters
        ----------
        chosen : (s,) array_like of int
            Vertices of the mesh.

        Returns
        -------
        list of ((t,) ndarray of int, (t,) ndarray of int)
            For each part: which of those chosen are in it, in order, and as which of its vertices.

        Raises
        ------
        InvalidSettingsError
            If they are not vertices of the mesh.
        """
        try:
            wanted = np.atleast_1d(np.asarray(chosen))
        except ValueError:  # lists of several lengths
            wanted = np.zeros((0, 0))
        if wanted.ndim != 1 or not np.issubdtype(wanted.dtype, np.integer) or not wanted.size:
            raise InvalidSettingsError("Vertices to start from must be a list of at least one whole number.")
        if wanted.min() < 0 or wanted.max() >= len(self.vertices):
            raise InvalidSettingsError(f"Vertices to start from must lie between 0 and {len(self.vertices) - 1}.")
        wanted = self._stands_for[wanted.astype(np.int64)]
        found = []
        for part in self.parts:
            at = np.minimum(np.searchsorted(part.vertices, wanted), len(part.vertices) - 1)
            here = np.flatnonzero(part.vertices[at] == wanted)
            found.append((here, at[here]))
        return found

    def each(self, monitor: Monitor, reach: float = 1.0) -> Iterator[tuple[Part, Monitor]]:
        """Go through the parts, with a monitor for each that tells its share of the whole.

        Parameters
        ----------
        monitor : Monitor
            Of the whole; takes timings and warnings of the parts.
        reach : float
            How far the stages of the work on a part go, at most 1.

        Yields
        ------
        (Part, Monitor)
            The part, and what its work reports to.
        """
        ends = np.cumsum([len(part.vertices) for part in self.parts])
        said: list[str] = []
        for part, share in zip(self.parts, ends / ends[-1], strict=True):
            own = monitor.until(float(share), reach)
            yield part, own
            said += [sentence for sentence in own.warnings if sentence not in said]
        monitor.warnings += said[:_SAID]
        if len(said) > _SAID:
            monitor.warn(f"There are {len(said) - _SAID} more warnings like these about other parts.")


def connected_parts(vertices: ArrayLike, faces: ArrayLike, monitor: Monitor | None = None) -> Parts:
    """Find the connected surfaces in a mesh.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles as vertex indices.
    monitor : Monitor, optional
        Asked between the steps whether to stop.

    Returns
    -------
    Parts
        The surfaces.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    CancelledError
        If the monitor says so.
    """
    monitor = monitor or Monitor()
    mesh = mended(vertices, faces, monitor)
    points = mesh.vertices
    apart: list[str] = []
    part_of = component_labels(len(points), mesh.faces)[mesh.faces[:, 0]]
    monitor.check()
    pieces = [mesh.faces]
    if (part_of != part_of[0]).any():
        order = np.argsort(part_of, kind="stable")
        pieces = np.split(mesh.faces[order], np.flatnonzero(np.diff(part_of[order])) + 1)
    if len(pieces) > _MOST:
        raise InvalidMeshError(
            f"The mesh falls into {len(pieces):,} loose parts, more than {_MOST}. Merge what belongs together (Edit "
            "Mode: M > By Distance), or delete or separate the small parts (P > By Loose Parts), and run again."
        )
    found = [_part(points, piece) for piece in pieces]
    usable = found if len(found) == 1 else [part for part in found if has_area(part.points, part.faces)]
    monitor.check()
    largest = max(np.abs(part.points).max() for part in usable)
    area = np.array([surface_area(part.points / largest, part.faces) for part in usable] if usable[1:] else [1.0])
    order = np.lexsort(([part.vertices[0] for part in usable], -np.round(area / area.sum() / _ALIKE)))
    parts = [usable[index] for index in order]
    if len(usable) < len(pieces):
        apart.append(f"Loose parts without any area ({len(pieces) - len(usable)}) stay where they are.")
    if len(parts) > 1:
        apart.append(
            f"The mesh has {len(parts)} loose parts. Each got feature points and a form of its own and stays in its "
            "place; parts that should move together have to be joined first."
        )
    on_surface = np.zeros(len(points), dtype=bool)
    on_surface[mesh.faces] = True
    loose = int(np.count_nonzero(~on_surface[mesh.stands_for]))
    if loose:
        which = f"{loose:,} vertices that belong to no face stay where they are"
        if loose == 1:
            which = "1 vertex that belongs to no face stays where it is"
        apart.append(f"{which}. Mesh > Clean Up > Delete Loose removes such vertices.")
    used = mesh.faces
    if len(usable) < len(pieces):
        used = np.concatenate([part.vertices[part.faces] for part in parts])
    return Parts(parts, points, used, mesh.warnings, apart, mesh.stands_for)


def _part(points: FloatArray, faces: IntArray) -> Part:
    """Give the vertices of some triangles numbers of their own."""
    if faces.size < len(points):
        vertices, corners = np.unique(faces, return_inverse=True)
        return Part(vertices, points[vertices], corners.reshape(-1, 3).astype(np.int64))
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    vertices = np.flatnonzero(used)
    if len(vertices) == len(points):
        return Part(vertices, points, faces)
    number = np.cumsum(used) - 1
    return Part(vertices, points[vertices], number[faces])


def features_by_part(parts: Parts, given: Sequence[int] | None) -> list[tuple[IntArray, IntArray] | None]:
    """Hand feature points that are given to the parts that they are in.

    Parameters
    ----------
    parts : Parts
        The mesh.
    given : sequence of int, or None
        Vertices of the mesh.

    Returns
    -------
    list of ((t,) ndarray of int, (t,) ndarray of int) or None
        For each part: positions in the list and vertices of the part; None where they are to be detected.

    Raises
    ------
    InvalidSettingsError
        If they are not vertices of a surface, or one is named twice.
    """
    if given is None:
        return [None] * len(parts.parts)
    features, count = np.asarray(given), len(parts.vertices)
    if features.ndim != 1 or not features.size or not np.issubdtype(features.dtype, np.integer):
        raise InvalidSettingsError("feature_points must be a list of at least one vertex index.")
    if features.min() < 0 or features.max() >= count:
        raise InvalidSettingsError(f"feature_points must lie between 0 and {count - 1}.")
    if len(np.unique(features)) < len(features):
        raise InvalidSettingsError("feature_points names a vertex twice.")
    placed = parts.placed(features)
    if sum(len(here) for here, _ in placed) < len(features):
        raise InvalidSettingsError("feature_points names vertices that belong to no face with area.")
    for here, vertices in placed:
        if len(np.unique(vertices)) < len(here):
            raise InvalidSettingsError(
                "feature_points names two vertices at one place, where borders lie on each other."
            )
    return [each if len(each[0]) else None for each in placed]
