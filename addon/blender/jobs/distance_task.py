"""Distance fields from the selected vertices, shown as colours and as a vertex group."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError
from ...core.distances.kinds import KINDS
from ..mesh_items.colour_attributes import add_colours
from ..mesh_items.fingerprints import colour_fingerprint, group_fingerprints
from ..mesh_items.group_weights import fill_group
from ..mesh_items.palette import ramp, with_isolines
from ..objects.combining import Combined, combined, touching
from ..objects.mesh_reading import find_object, read_object, require_unchanged, selected_vertices
from ..objects.object_states import object_mode
from ..records.distance_record import WrittenField, read_distances, write_distances
from ..words.advice import advised
from ..words.wording import told

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray
    from ...core.run.monitor import Cancelled, Progress

WEIGHTS = "{} Weights"  # the vertex group; Blender shows a group instead of colours of the same name


class DistanceTask:
    """A distance field from the selected vertices of an object, over all objects of its body.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects accepted by `refusal`: the one with the selection first, then those that may belong to its body.
    kind : str
        One of `addon.core.distances.kinds.KINDS`.
    isolines : int
        Number of isolines in the colours; 0 for none.
    memory_limit : float
        Memory limit in gigabytes; 0 for 60 % of the free memory.

    Attributes
    ----------
    warnings : list of str
        Sentences for the user.

    Raises
    ------
    CanonicalFormError
        If no vertex of the first object is selected, or all are.
    """

    def __init__(
        self, objects: Sequence[bpy.types.Object], kind: str, isolines: int, *, memory_limit: float = 0.0
    ) -> None:
        self.kind, self.isolines, self.memory_limit = kind, isolines, memory_limit
        first = {obj.data: obj for obj in reversed(objects)}  # objects that share a mesh show one field
        with object_mode(objects[0]):
            self._readings = [read_object(obj) for obj in reversed(first.values())]
            self._sources = selected_vertices(objects[0].data)
        if not len(self._sources):
            raise CanonicalFormError(told("No vertex is selected. In Edit Mode, select the vertices to measure from."))
        if len(self._sources) == len(self._readings[0].vertices):
            raise CanonicalFormError(
                told("All vertices are selected. In Edit Mode, select only those to measure from.")
            )
        self._field: FloatArray = np.zeros(0)
        self._whole: Combined | None = None
        self.warnings: list[str] = []
        self.group = ""

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute the field; does not access Blender's data.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `distance_field`.

        Raises
        ------
        CanonicalFormError
            If the mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        from ...core.distance_fields import distance_field

        if len(self._readings) > 1:
            body = touching(self._readings, together=True, cancelled=cancelled)[0]
            self._readings = [self._readings[index] for index in body]
        whole = combined(self._readings)
        self._field = distance_field(
            whole.vertices,
            whole.faces,
            whole.numbers_of([self._sources.tolist(), *([] for _ in self._readings[1:])]),
            self.kind,
            progress=progress,
            cancelled=cancelled,
            warned=lambda sentence: self.warnings.append(advised(sentence)),
            memory_limit=self.memory_limit,
        )
        self._whole = whole

    @property
    def unreached(self) -> int:
        """Number of vertices that are not connected to the selection."""
        return int(np.count_nonzero(~np.isfinite(self._field)))

    def write(self) -> str:
        """Write the field, replacing an earlier one of the same kind, in the main thread.

        Returns
        -------
        str
            Name of the colour attribute.

        Raises
        ------
        CanonicalFormError
            If an object was removed or changed; the message says why.
        """
        assert self._whole is not None
        objects = [find_object(reading) for reading in self._readings]
        with ExitStack() as modes:
            for obj, reading in zip(objects, self._readings, strict=True):
                modes.enter_context(object_mode(obj))
                require_unchanged(obj, reading)
            colours = ramp(self._field)
            if self.isolines:
                colours = with_isolines(colours, self._field, self.isolines)
            split = self._whole.split
            parts = zip(objects, split(colours), split(_weights(self._field)), strict=True)
            names = [_write_field(obj, KINDS[self.kind].label, *each) for obj, *each in parts]
        self.group = objects[0].vertex_groups.active.name
        return names[0]


def _weights(field: FloatArray) -> FloatArray:
    """Scale a field to weights from 0 to 1; NaN where it is infinite."""
    reached = np.isfinite(field)
    largest = float(field[reached].max())
    return np.where(reached, field, np.nan) / (largest if largest > 0 else 1.0)


def _write_field(obj: bpy.types.Object, name: str, field_colours: FloatArray, weights: FloatArray) -> str:
    written = read_distances(obj.data)
    earlier = written.get(name, WrittenField())
    colours = _write_colours(obj, name, field_colours, earlier)
    written[name] = WrittenField(*colours, *_write_weights(obj, WEIGHTS.format(name), weights, earlier))
    write_distances(obj.data, written)
    obj.data.update()
    return colours[0]


def _write_colours(obj: bpy.types.Object, name: str, colours: FloatArray, earlier: WrittenField) -> tuple[str, str]:
    """Write colours, replacing unchanged earlier ones; return the attribute's name and fingerprint."""
    layers = obj.data.color_attributes
    attribute = layers.get(earlier.colours)
    if attribute is None or earlier.colours_fingerprint != colour_fingerprint(attribute):
        attribute = add_colours(obj, name)
    attribute.data.foreach_set("color", colours.astype(np.float32).ravel())
    written = str(attribute.name), colour_fingerprint(attribute)
    layers.active_color_name = written[0]
    return written


def _write_weights(obj: bpy.types.Object, name: str, weights: FloatArray, earlier: WrittenField) -> tuple[str, str]:
    """Write weights from 0 to 1, replacing unchanged earlier ones; return the group's name and fingerprint."""
    found = group_fingerprints(obj, {earlier.weights: earlier.weights_fingerprint})
    if found.get(earlier.weights) == earlier.weights_fingerprint:
        group = obj.vertex_groups[earlier.weights]
    else:
        group = obj.vertex_groups.new(name=name)
    written = fill_group(group, weights)
    obj.vertex_groups.active_index = group.index
    return group.name, written
