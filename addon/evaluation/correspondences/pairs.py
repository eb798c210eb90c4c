"""Pairs of poses of one mesh: identical vertex indices are the true correspondences."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...core import CanonicalFormError, InvalidMeshError
from ..dataset import Shape
from ..reading import Reader
from ..tables import evenly
from .matchers import Mesh


@dataclass(frozen=True)
class Pair:
    """A mesh and another pose of it, or of another body with the same vertices.

    Attributes
    ----------
    one : Shape
        The mesh to match.
    other : Shape
        The mesh to match it with, after it was reduced and shuffled.
    """

    one: Shape
    other: Shape

    @property
    def label(self) -> str:
        """The class, or the two classes."""
        one, other = self.one.label, self.other.label
        return one if one == other else f"{one} onto {other}"

    @property
    def name(self) -> str:
        """Name of the pair in the store."""
        return f"{self.one.label}@{self.one.name}@{self.other.label}@{self.other.name}"


class Poses:
    """The meshes of shapes, read on first access.

    Parameters
    ----------
    reader : Reader
        Reads the meshes.
    """

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self._meshes: dict[Path, Mesh] = {}

    def mesh(self, shape: Shape) -> Mesh:
        """Read a mesh.

        Parameters
        ----------
        shape : Shape
            The shape.

        Returns
        -------
        Mesh
            The mesh.

        Raises
        ------
        InvalidMeshError
            If it cannot be read.
        """
        if shape.path not in self._meshes:
            self._meshes[shape.path] = Mesh(*self._reader.triangles(shape.path))
        return self._meshes[shape.path]


def pairs_of(shapes: Sequence[Shape], count: int, across: bool, poses: Poses) -> tuple[list[Pair], dict[str, str]]:
    """Return the pairs within each class, and those between classes with the same triangles.

    Parameters
    ----------
    shapes : sequence of Shape
        The dataset.
    count : int
        Largest number of poses per class, evenly chosen.
    across : bool
        Whether to match classes with the same triangles with each other as well.
    poses : Poses
        The meshes.

    Returns
    -------
    pairs : list of Pair
        Every pose with every other one, by class.
    left_out : dict of str to str
        Classes without pairs, and the reasons.

    Raises
    ------
    InvalidMeshError
        If there are no pairs.
    """
    chosen: dict[str, list[Shape]] = {}
    left_out: dict[str, str] = {}
    for label in sorted({shape.label for shape in shapes}):
        some = evenly([shape for shape in shapes if shape.label == label], count)
        try:
            faces = [poses.mesh(shape).faces for shape in some]
        except (CanonicalFormError, OSError) as error:
            left_out[label] = str(error)
            continue
        if not all(np.array_equal(each, faces[0]) for each in faces):
            left_out[label] = "Its meshes have different triangles, so that the true match is not known."
        else:
            chosen[label] = some
    pairs = [
        Pair(*pair)
        for one, other in itertools.product(chosen, repeat=2)
        if one == other or (across and _share(chosen[one][0], chosen[other][0], poses))
        for pair in _ordered(chosen[one], chosen[other])
    ]
    if not pairs:
        raise InvalidMeshError("No class has two poses of the same vertices: a true match is not known.")
    return pairs, left_out | {
        label: "It has one pose." for label, some in chosen.items() if len(some) < 2 and not across
    }


def _share(one: Shape, other: Shape, poses: Poses) -> bool:
    """Return whether two classes have the same triangles."""
    return np.array_equal(poses.mesh(one).faces, poses.mesh(other).faces)


def _ordered(some: Sequence[Shape], others: Sequence[Shape]) -> Iterator[tuple[Shape, Shape]]:
    """Pair every shape with every other; pairs with the same second shape are consecutive."""
    return ((one, other) for other in others for one in some if one != other)
