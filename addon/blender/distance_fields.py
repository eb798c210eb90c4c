"""Distance tools: fields measured from chosen vertices, shown as colours and as a vertex group."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..core import CanonicalFormError
from .mesh_reading import found_again, object_mode, read_object, require_unchanged, selected_vertices
from .palette import ramp, with_isolines
from .records import DISTANCES, colour_print, free_name, group_prints

if TYPE_CHECKING:
    from ..core.numerics.arrays import FloatArray
    from ..core.run.monitor import Cancelled, Progress

WEIGHTS = "{} Weights"  # the vertex group: one of the colours' own name would hide them from the view
NAMES = {  # of the colours, by the core's name of the kind
    "heat": "Heat Geodesic",
    "fast_marching": "Fast Marching",
    "biharmonic": "Biharmonic Distance",
    "commute_time": "Commute Time",
}


class DistanceTask:
    """A distance field from the selected vertices of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`.
    kind : str
        One of `NAMES`.
    isolines : int
        Number of lines of equal distance in the colours; 0 for none.
    memory_limit : float
        Gigabytes that the computation may take; 0 for 60 % of the free memory.

    Attributes
    ----------
    warnings : list of str
        What the computation had to say, for the user.

    Raises
    ------
    CanonicalFormError
        If no vertex is selected.
    """

    def __init__(self, obj: bpy.types.Object, kind: str, isolines: int, memory_limit: float = 0.0) -> None:
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
        """Measure; touches no data of Blender's.

        Parameters
        ----------
        progress, cancelled : callable, optional
            As in `distance_field`.

        Raises
        ------
        CanonicalFormError
            If the mesh cannot be used, or the run was cancelled; the message says what to do.
        """
        from ..core.distance_field import distance_field

        reading = self._reading
        self._field = distance_field(
            reading.vertices,
            reading.faces,
            self._sources,
            self.kind,
            progress,
            cancelled,
            self.warnings.append,
            self.memory_limit,
        )

    @property
    def unreached(self) -> int:
        """Number of vertices to which no way leads from the selection."""
        return int(np.count_nonzero(~np.isfinite(self._field)))

    def write(self) -> str:
        """Write the field, in place of an earlier one of its kind, on the main thread.

        Returns
        -------
        str
            Name of the colour attribute.

        Raises
        ------
        CanonicalFormError
            If the object is gone or changed; the message says why.
        """
        obj = found_again(self._reading)
        with object_mode(obj):
            require_unchanged(obj, self._reading)
            return _write_field(obj, NAMES[self.kind], self._field, self.isolines)


def _write_field(obj: bpy.types.Object, name: str, field: FloatArray, isolines: int) -> str:
    mesh = obj.data
    colours = ramp(field)
    if isolines:
        colours = with_isolines(colours, field, isolines)
    ours: dict[str, list[str]] = json.loads(mesh.get(DISTANCES, "{}"))  # what it is: its name and fingerprint
    shown, known = ours.get(f"{name} colours", ["", ""])
    attribute = mesh.color_attributes.get(shown)
    if attribute is None or known != colour_print(attribute):
        attribute = mesh.color_attributes.new(name=free_name(obj, name), type="FLOAT_COLOR", domain="POINT")
    shown = str(attribute.name)  # the attribute itself moves in memory when others are added
    attribute.data.foreach_set("color", colours.astype(np.float32).ravel())
    ours[f"{name} colours"] = [shown, colour_print(attribute)]
    mesh.color_attributes.active_color_name = shown
    group_name, known = ours.get(f"{name} weights", ["", ""])
    if group_prints(obj, {group_name: None}).get(group_name) == known and group_name:
        group = obj.vertex_groups[group_name]
    else:
        group = obj.vertex_groups.new(name=WEIGHTS.format(name))
    reached = np.isfinite(field)
    group.remove(np.flatnonzero(~reached).tolist())
    largest = float(field[reached].max())
    weights = np.round(np.where(reached, field, np.nan) / (largest if largest > 0 else 1.0), 3)
    for weight in np.unique(weights[reached]).tolist():  # at most 1,001 calls, whatever the number of vertices
        group.add(np.flatnonzero(weights == weight).tolist(), weight, "REPLACE")
    ours[f"{name} weights"] = [group.name, group_prints(obj, {group.name: None})[group.name]]
    obj.vertex_groups.active_index = group.index
    mesh[DISTANCES] = json.dumps(ours)
    mesh.update()
    return shown
