"""Classical multidimensional scaling of geodesic distances: all pairs, or landmarks that place the rest.

Elad and Kimmel, "On bending invariant signatures for surfaces", 2003, doi:10.1109/TPAMI.2003.1233902; De Silva and
Tenenbaum, "Sparse multidimensional scaling using landmark points", 2004.
"""

from __future__ import annotations

from ..embedding.classical_scaling import raw_stress
from ..method_api.catalogue import Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import WholeSurface
from ..run.monitor import Monitor


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface by classical scaling of its geodesic distances."""
    whole = WholeSurface(found, settings, monitor)
    with monitor.stage("Distances"):
        samples = whole.samples()
    with monitor.stage("Embedding"):
        form = samples.classical_embedding()
        monitor.check()
        return whole.embedding(form, [raw_stress(form[samples.vertices], samples.between)], samples.distances.size)


METHODS = (
    Method(
        name="classical",
        label="Classical MDS",
        help="Classical scaling of geodesics; flattens limbs (Elad and Kimmel 2003)",
        source="Elad and Kimmel 2003",
        unfold=_form,
        stages={"Distances": 50, "Embedding": 9},
        uses=("landmark_count",),
        pairs="all",
        rank=1,
    ),
)
