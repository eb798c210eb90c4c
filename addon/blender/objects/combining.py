"""Several objects as one mesh in a shared space, and back."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...core import CanonicalFormError, InvalidSettingsError
from ...core.mesh.mirroring import Mirrored, mirrored
from ...core.numerics.arrays import FloatArray, IntArray
from ...core.symmetry.limb_names import mate_of
from ..words.wording import told
from .mesh_reading import Reading

if TYPE_CHECKING:
    from ...core.run.monitor import Cancelled
    from .body_points import BodyPoints

_FLATTEST = 1e-9  # smallest determinant of a transform, as a share of its largest scale cubed


class Combined(NamedTuple):
    """Objects as one mesh, including mirror images shown by modifiers. A single object stays in its local space.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Positions of all vertices.
    faces : (m, 3) ndarray of int
        All triangles.
    starts : (k + 1,) ndarray of int
        Index of the first vertex of each object, and the number of vertices.
    objects : list of Mirrored
        The mesh of each object in its local space, with its images.
    placements : list of (4, 4) ndarray of float
        Transforms from the local space of each object.
    rest : (n, 3) ndarray of float or None
        Positions of all vertices in the rest pose of the rig; None if it is not known.
    """

    vertices: FloatArray
    faces: IntArray
    starts: IntArray
    objects: list[Mirrored]
    placements: list[FloatArray]
    rest: FloatArray | None = None

    def split(self, values: np.ndarray) -> list[np.ndarray]:
        """Split values on all vertices by object.

        Parameters
        ----------
        values : (n, ...) ndarray
            The values.

        Returns
        -------
        list of ndarray
            Values of each object, without its images.
        """
        return [values[start : start + each.half] for start, each in zip(self.starts, self.objects, strict=False)]

    def owned(self, vertices: IntArray) -> list[IntArray]:
        """Locate vertices on each object.

        Parameters
        ----------
        vertices : (s,) ndarray of int
            Vertices of the combined mesh.

        Returns
        -------
        list of (s,) ndarray of int
            Their indices on each object; -1 for vertices of another object or of an image.
        """
        pairs = zip(self.starts, self.objects, strict=False)
        return [
            np.where((start <= vertices) & (vertices < start + each.half), vertices - start, -1)
            for start, each in pairs
        ]

    def spread(self, values: Sequence[np.ndarray]) -> np.ndarray:
        """Combine the values of all objects; images get the values of their originals.

        Parameters
        ----------
        values : sequence of ndarray
            Values of each object.

        Returns
        -------
        (n, ...) ndarray
            Values on all vertices.
        """
        return np.concatenate([own[each.source] for own, each in zip(values, self.objects, strict=True)])

    def numbers_of(self, vertices: Sequence[Sequence[int]], called: str = "feature_points") -> list[int]:
        """Convert vertex indices of the objects to indices on the combined mesh, including their images.

        Parameters
        ----------
        vertices : sequence of sequence of int
            Vertex indices of each object.
        called : str
            The option that they are of.

        Returns
        -------
        list of int
            Indices on the combined mesh: for each object its vertices in the given order, then their images.

        Raises
        ------
        InvalidSettingsError
            If a vertex does not exist on its object.
        """
        found: list[int] = []
        for start, own, each in zip(self.starts, vertices, self.objects, strict=False):
            if any(not 0 <= vertex < each.half for vertex in own):
                raise InvalidSettingsError("vertex_range", name=called, last=each.half - 1)
            images = np.flatnonzero(np.isin(each.source, own))
            images = images[images >= each.half]
            found += [int(start) + vertex for vertex in (*own, *images.tolist())]
        return found

    def points_of(self, points: Sequence[BodyPoints]) -> tuple[list[int], list[str]]:
        """Convert feature points of the objects to the combined mesh; images are of the other side.

        Parameters
        ----------
        points : sequence of BodyPoints
            Points on each object.

        Returns
        -------
        vertices : list of int
            As `numbers_of`; a head, or a tail, has no image.
        names : list of str
            Their names; "" for none, and for what has its name already.
        """
        found = self.numbers_of([each.vertices for each in points])
        sources = np.concatenate([start + each.source for start, each in zip(self.starts, self.objects, strict=False)])
        known = {
            int(start) + vertex: name
            for start, own in zip(self.starts, points, strict=False)
            for vertex, name in zip(*own, strict=True)
        }
        given = {name for each in points for name in each.names}
        vertices: list[int] = []
        names: list[str] = []
        for vertex, source in zip(found, sources[found].tolist(), strict=True):
            own = known[source]
            name, image = (own, False) if vertex == source else (mate_of(own), True)
            if not image or not own or name != own:
                vertices.append(vertex)
                names.append("" if name in names or (image and name in given) else name)
        return vertices, names

    def put_together(self, shapes: Sequence[FloatArray]) -> FloatArray:
        """Combine positions of all objects.

        Parameters
        ----------
        shapes : sequence of (p, 3) ndarray of float
            Positions of the vertices of each object, in its local space.

        Returns
        -------
        (n, 3) ndarray of float
            Positions of all vertices.
        """
        whole = [
            each.spread(points) if each.mirrors else points for points, each in zip(shapes, self.objects, strict=True)
        ]
        if len(whole) == 1:
            return whole[0]
        return np.concatenate([moved(points, each) for points, each in zip(whole, self.placements, strict=True)])

    def brought_back(self, shape: FloatArray) -> list[FloatArray]:
        """Split positions by object into local space; mirrored shapes are made symmetric first.

        Parameters
        ----------
        shape : (n, 3) ndarray of float
            Positions of all vertices.

        Returns
        -------
        list of ndarray of float
            Positions of each object.
        """
        parts = self._own_parts(shape)
        return [each.symmetrised(own)[: each.half] for own, each in zip(parts, self.objects, strict=True)]

    def asymmetries(self, shape: FloatArray) -> list[float]:
        """Measure the distance of mirrored objects from their images.

        Parameters
        ----------
        shape : (n, 3) ndarray of float
            Positions of all vertices.

        Returns
        -------
        list of float
            Distance for each object, in units of sqrt(area) of the object; 0 without a mirror.
        """
        parts = zip(self._own_parts(shape), self.objects, strict=True)
        return [each.asymmetry(own) if each.mirrors else 0.0 for own, each in parts]

    def _own_parts(self, shape: FloatArray) -> list[FloatArray]:
        """Split positions by object, images included, into local space."""
        parts = [shape[start:end] for start, end in pairwise(self.starts)]
        if len(parts) == 1:
            return parts
        return [moved(own, np.linalg.inv(each)) for own, each in zip(parts, self.placements, strict=True)]


def combined(readings: Sequence[Reading]) -> Combined:
    """Combine objects into one mesh.

    Parameters
    ----------
    readings : sequence of Reading
        The objects, at least one.

    Returns
    -------
    Combined
        The combined mesh.

    Raises
    ------
    CanonicalFormError
        If an object has a scale of zero along an axis.
    """
    objects = [mirrored(each.vertices, each.faces, each.mirrors) for each in readings]
    starts = np.cumsum([0, *(len(each.vertices) for each in objects)])
    placements = [each.placement for each in readings]
    whole = Combined(objects[0].vertices, objects[0].faces, starts, objects, placements)
    if len(readings) > 1:
        for reading in readings:
            require_thick(reading.name, reading.placement)
        places = zip(objects, placements, starts[:-1], strict=True)
        faces = np.concatenate([outward(each.faces, place) + start for each, place, start in places])
        whole = whole._replace(vertices=whole.put_together([each.vertices for each in readings]), faces=faces)
    rests = [each.rest for each in readings if each.rest is not None]
    return whole._replace(rest=whole.put_together(rests)) if len(rests) == len(readings) else whole


def touching(readings: Sequence[Reading], *, together: bool, cancelled: Cancelled | None = None) -> list[list[int]]:
    """Group the objects that belong to one body.

    Parameters
    ----------
    readings : sequence of Reading
        The objects, at least one.
    together : bool
        Whether pieces that belong together form one body; otherwise each object is a group of its own.
    cancelled : callable, optional
        As in `canonical_form`.

    Returns
    -------
    list of list of int
        Groups of object indices; groups, and objects within a group, keep their order.

    Raises
    ------
    CanonicalFormError
        If the meshes cannot be used, or the run was cancelled; the message names the remedy.
    """
    from ...core.assembly.gathering import gathered
    from ...core.assembly.opening import known_bodies
    from ...core.mesh.connectivity import component_labels
    from ...core.run.monitor import Monitor

    if not together:
        return [[index] for index in range(len(readings))]
    whole = combined(readings)
    bodies = known_bodies(whole.vertices, whole.faces, Monitor(None, cancelled), rest=whole.rest)
    labels = [np.full(len(body.vertices), number) for number, body in enumerate(bodies.bodies)]
    body_of = gathered(bodies, labels, np.full(len(whole.vertices), -1))
    own = np.repeat(np.arange(len(readings)), np.diff(whole.starts))
    shared = np.unique(np.column_stack([own, len(readings) + body_of])[body_of >= 0], axis=0)
    label = component_labels(len(readings) + len(labels), shared)[: len(readings)]
    _, first = np.unique(label, return_index=True)
    return [np.flatnonzero(label == label[index]).tolist() for index in np.sort(first)]


def concatenated(parts: Sequence[tuple[FloatArray, IntArray]]) -> tuple[FloatArray, IntArray, IntArray]:
    """Put meshes into one, each after the other.

    Parameters
    ----------
    parts : sequence of ((n, 3) ndarray of float, (m, 3) ndarray of int)
        Positions and triangles of each, at least one.

    Returns
    -------
    vertices, faces : ndarray
        Those of all.
    starts : (p + 1,) ndarray of int
        Where the vertices of each begin, and where the last ends.
    """
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    faces = np.concatenate([own + start for (_, own), start in zip(parts, starts, strict=False)])
    return np.concatenate([points for points, _ in parts]), faces, starts


def moved(points: FloatArray, transform: FloatArray) -> FloatArray:
    """Transform points.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        The points.
    transform : (4, 4) ndarray of float
        The transform, for column vectors.

    Returns
    -------
    (n, 3) ndarray of float
        The transformed points.
    """
    return points @ transform[:3, :3].T + transform[:3, 3]


def outward(faces: IntArray, transform: FloatArray) -> IntArray:
    """Flip triangles where a transform mirrors them, so that their normals still point outward.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        The triangles.
    transform : (4, 4) ndarray of float
        The transform of their vertices.

    Returns
    -------
    (m, 3) ndarray of int
        The triangles, flipped if the transform mirrors.
    """
    return faces[:, ::-1] if np.linalg.det(transform[:3, :3]) < 0 else faces


def require_thick(name: str, placement: FloatArray, *, alone: bool = False) -> None:
    """Reject an object that its transform flattens.

    Parameters
    ----------
    name : str
        Name of the object.
    placement : (4, 4) ndarray of float
        Its transform.
    alone : bool
        Whether this is the only object of the run.

    Raises
    ------
    CanonicalFormError
        If it has a scale of zero along an axis.
    """
    axes = placement[:3, :3]
    if not abs(np.linalg.det(axes)) > _FLATTEST * float(np.abs(axes).max()) ** 3:
        sentence = (
            told("{name} has a scale of 0 along an axis. Change its scale.", name=name)
            if alone
            else told(
                "{name} has a scale of 0 along an axis. Change its scale, or set Several Objects to Each.", name=name
            )
        )
        raise CanonicalFormError(sentence)
