"""Contacts of a body, and the body parted there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..assembly.unfolded_bodies import unfolded_shape
from ..method_api.settings import Settings
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from ..run.messages import Message
from ..run.monitor import Cancelled, Monitor
from ..run.summaries import Summarised
from .on_given import Given
from .parting import PartedMesh, capped, laid_open


@dataclass(frozen=True, eq=False, repr=False)
class Contacts(Summarised):
    """Where the skin of a body has grown together.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The vertices as given.
    representative : (n,) ndarray of int
        The vertex that stands for each: itself, or of coincident ones the first.
    faces : (m', 3) ndarray of int
        The triangles of those that stand for others: those given, repaired where the warnings say so.
    size : float
        Square root of the area of the largest body, the only one that is looked at.
    gone : (m',) ndarray of bool
        Triangles in which two parts of the body have grown together, or that were marked.
    cut : (e, 2) ndarray of int
        Edges that were marked.
    places : (n, 3) ndarray of float
        The place of each vertex on the mannequin, which stands with arms and legs spread, or on the form of the
        reference, in units of sqrt(area); that of the mesh where the body is not explained.
    between : list of (str, str)
        By contact, the bones of the mannequin on either side, or the numbers of the patches of the reference.
    explained : bool
        Whether the body is a human one, or one like the reference; of others nothing is known.
    residual : float
        Mean distance of the skin from that of the mannequin, in sizes of the body; or from that of the reference, in
        units of sqrt(area).
    timings : dict of str to float
        Seconds by stage.
    warnings : list of Message
        Sentences for the user, on the mesh as given.
    """

    vertices: FloatArray
    representative: IntArray
    faces: IntArray
    size: float
    gone: BoolArray
    cut: IntArray
    places: FloatArray
    between: list[tuple[str, str]]
    explained: bool
    residual: float
    timings: dict[str, float]
    warnings: list[Message]

    @property
    def touched(self) -> BoolArray:
        """Which vertices lie in a contact, (n,); copies at one place do so together."""
        found = np.zeros(len(self.vertices), dtype=bool)
        found[self.faces[self.gone].ravel()] = True
        found[self.cut.ravel()] = True
        return found[self.representative]

    @property
    def given(self) -> Given:
        """The mesh as given."""
        return Given(self.vertices, self.faces, self.representative, self.touched)

    def parted(self, *, cancelled: Cancelled | None = None) -> PartedMesh:
        """Take those triangles out, part those edges, and close both sides by caps.

        Caps are short on the body at rest: on the mannequin, or if nothing is known of the body, on the form of what
        was parted.

        Parameters
        ----------
        cancelled : callable, optional
            As in `canonical_form`.

        Returns
        -------
        PartedMesh
            The mesh without contacts.

        Raises
        ------
        CanonicalFormError
            As in `canonical_form`.
        """
        mesh = laid_open(self.vertices, self.faces, self.gone, self.cut, self.size)
        if self.explained or not mesh.lips:
            return capped(mesh, self.places[mesh.origin], self.size)
        rest = unfolded_shape(mesh.apart, mesh.faces, Settings(quality="draft"), Monitor(cancelled=cancelled))
        return capped(mesh, rest, self.size)
