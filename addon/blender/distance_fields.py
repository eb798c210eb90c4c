"""Distance fields from the selected vertices, shown as colours and as a vertex group."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import CanonicalFormError
from ..core.distances.kinds import KINDS
from .advice import advised
from .colour_attributes import add_colours
from .distance_record import WrittenField, read_distances, write_distances
from .fingerprints import colour_fingerprint, group_fingerprints
from .mesh_reading import find_object, read_object, require_unchanged, selected_vertices
from .object_states import object_mode
from .palette import ramp, with_isolines

if TYPE_CHECKING:
    from ..core.numerics.arrays import FloatArray
    from ..core.run.monitor import Cancelled, Progress

WEIGHTS = "{} Weights"  # the vertex group; Blender shows a group in place of colours of the same name


class DistanceTask:
    """A distance field from the selected vertices of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`.
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
        If no vertex is selected, or all are.
    """

    def __init__(self, obj: bpy.types.Object, kind: str, isolines: int, *, memory_limit: float = 0.0) -> None:
        self.kind, self.isolines, self.memory_limit = kind, isolines, memory_limit
        with object_mode(obj):
            self._reading = read_object(obj)
            self._sources = selected_vertices(obj.data)
        if not len(self._sources):
            raise CanonicalFormError("No vertex is selected. In Edit Mode, select the vertices to measure from.")
        if len(self._sources) == len(self._reading.vertices):
            raise CanonicalFormError("All vertices are selected. In Edit Mode, select only those to measure from.")
        self._field: FloatArray = np.zeros(0)
        self.warnings: list[str] = []

    def compute(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        """Compute the field; touches no data of Blender's.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `distance_field`.

        Raises
        ------
        CanonicalFormError
            If the mesh cannot be used, or the run was cancelled; the message names the remedy.
        """
        from ..core.distance_fields import distance_field

        reading = self._reading
        self._field = distance_field(
            reading.vertices,
            reading.faces,
            self._sources,
            self.kind,
            progress=progress,
            cancelled=cancelled,
            warned=lambda sentence: self.warnings.append(advised(sentence)),
            memory_limit=self.memory_limit,
        )

    @property
    def unreached(self) -> int:
        """Number of vertices that are not connected to the selection."""
        return int(np.count_nonzero(~np.isfinite(self._field)))

    def write(self) -> str:
        """Write the field, in place of an earlier one of the same kind, on the main thread.

        Returns
        -------
        str
            Name of the colour attribute.

        Raises
        ------
        CanonicalFormError
            If the object is gone or was changed; the message says why.
        """
        obj = find_object(self._reading)
        with object_mode(obj):
            require_unchanged(obj, self._reading)
            return _write_field(obj, KINDS[self.kind].label, self._field, self.isolines)


def _write_field(obj: bpy.types.Object, name: str, field: FloatArray, isolines: int) -> str:
    written = read_distances(obj.data)
    earlier = written.get(name, WrittenField())
    field_colours = ramp(field)
    if isolines:
        field_colours = with_isolines(field_colours, field, isolines)
    colours = _write_colours(obj, name, field_colours, earlier)
    weights = _write_weights(obj, WEIGHTS.format(name), field, earlier)
    written[name] = WrittenField(*colours, *weights)
    write_distances(obj.data, written)
    obj.data.update()
    return colours[0]


def _write_colours(obj: bpy.types.Object, name: str, colours: FloatArray, earlier: WrittenField) -> tuple[str, str]:
    """Write colours, in place of unchanged earlier ones; return the attribute's name and fingerprint."""
    layers = obj.data.color_attributes
    attribute = layers.get(earlier.colours)
    if attribute is None or earlier.colours_fingerprint != colour_fingerprint(attribute):
        attribute = add_colours(obj, name)
    attribute.data.foreach_set("color", colours.astype(np.float32).ravel())
    written = str(attribute.name), colour_fingerprint(attribute)
    layers.active_color_name = written[0]
    return written


def _write_weights(obj: bpy.types.Object, name: str, field: FloatArray, earlier: WrittenField) -> tuple[str, str]:
    """Write weights from 0 to 1, in place of unchanged earlier ones; return the group's name and fingerprint."""
    known = group_fingerprints(obj, [earlier.weights]).get(earlier.weights)
    if known is not None and known == earlier.weights_fingerprint:
        group = obj.vertex_groups[earlier.weights]
    else:
        group = obj.vertex_groups.new(name=name)
    reached = np.isfinite(field)
    group.remove(np.flatnonzero(~reached).tolist())
    largest = float(field[reached].max())
    weights = np.round(np.where(reached, field, np.nan) / (largest if largest > 0 else 1.0), 3)
    for weight in np.unique(weights[reached]).tolist():  # at most 1,001 calls, whatever the number of vertices
        group.add(np.flatnonzero(weights == weight).tolist(), weight, "REPLACE")
    obj.vertex_groups.active_index = group.index
    return group.name, group_fingerprints(obj, [group.name])[group.name]
