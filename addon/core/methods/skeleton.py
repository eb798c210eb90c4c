"""Straightening of the curve skeleton, which then drives the mesh.

Pickup, Sun, Rosin and Martin, "Skeleton-based canonical forms for non-rigid 3D shape retrieval", 2016,
doi:10.1007/s41095-016-0045-5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..embedding.smacof import smacof
from ..mesh.connectivity import component_labels
from ..mesh.edges import vertex_pairs
from ..mesh.geometry import vertex_areas
from ..method_api.catalogue import PATIENT, Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import WholeSurface
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

_RINGS = 40  # level sets between the root and the farthest vertex
_LEAST_RING = 1.5  # minimum width of a level set, in mean edges
_SMALL = 1e-3  # share of the area below which a node is merged with its neighbour
_PULL = 3.0  # 1/area: how firmly the vertices follow their nodes
_ROUNDS, _STEPS = 3, 12  # of moving every node's vertices to it, and of the deformation in each


@dataclass(frozen=True, eq=False)
class CurveSkeleton:
    """A graph of curves inside a surface.

    Attributes
    ----------
    nodes : (b, 3) ndarray of float
        Positions of the nodes.
    bones : (e, 2) ndarray of int
        Pairs of nodes.
    node_of : (n,) ndarray of int
        Node of every vertex of the surface.
    areas : (b,) ndarray of float
        Area of the vertices of each node.
    """

    nodes: FloatArray
    bones: IntArray
    node_of: IntArray
    areas: FloatArray

    def path_lengths(self) -> FloatArray:
        """Compute the shortest paths between all nodes along the bones. Gives (b, b)."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import dijkstra

        i, j = self.bones.T
        length = np.maximum(np.linalg.norm(self.nodes[i] - self.nodes[j], axis=1), 1e-12)
        graph = coo_matrix((length, (i, j)), shape=(len(self.nodes),) * 2).tocsr()
        return np.asarray(dijkstra(graph, directed=False))


def curve_skeleton(points: FloatArray, triangles: IntArray, from_root: FloatArray) -> CurveSkeleton:
    """Find the curve skeleton of a surface: the centres of the rings of equal distance from a root.

    `points` (n, 3); `triangles` (m, 3); `from_root` (n,).

    Examples
    --------
    >>> points = np.array([[x, y, 0.0] for x in range(9) for y in (0, 1)])
    >>> faces = np.array([[i + a, i + 2, i + b] for i in range(0, 16, 2) for a, b in ((0, 1), (1, 3))])
    >>> skeleton = curve_skeleton(points, faces, points[:, 0])
    >>> len(skeleton.bones) == len(skeleton.nodes) - 1
    True

    References
    ----------
    Verroust and Lazarus, "Extracting skeletal curves from 3D scattered data", 2000.
    """
    edges = vertex_pairs(triangles)
    edge = float(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1).mean())
    width = max(float(from_root.max()) / _RINGS, _LEAST_RING * edge)
    ring = np.floor(from_root / width).astype(np.int64)
    node_of = component_labels(len(points), edges[ring[edges[:, 0]] == ring[edges[:, 1]]])
    area = vertex_areas(points, triangles)
    total = float(area.sum())
    while True:  # small pieces of rings join the neighbour with which they share most edges
        areas = np.bincount(node_of, area).astype(np.float64)
        between = edges[node_of[edges[:, 0]] != node_of[edges[:, 1]]]
        if not len(between) or areas.min() >= _SMALL * total:
            break
        small = int(np.argmin(areas))
        pairs = node_of[between]
        beside = pairs[(pairs == small).any(axis=1)].sum(axis=1) - small
        node_of = np.where(node_of == small, int(np.argmax(np.bincount(beside))), node_of)
        node_of = np.unique(node_of, return_inverse=True)[1].reshape(-1)
    nodes = np.column_stack([np.bincount(node_of, area * points[:, axis]) for axis in range(3)]) / areas[:, None]
    bones = np.unique(np.sort(node_of[between], axis=1), axis=0).reshape(-1, 2)
    return CurveSkeleton(nodes, bones, node_of, areas)


def driven(body: ElasticBody, skeleton: CurveSkeleton, places: FloatArray, monitor: Monitor) -> FloatArray:
    """Deform a mesh as rigidly as possible so that its skeleton moves to given positions.

    `body`: the mesh; `skeleton`: its skeleton; `places` (b, 3); gives (n, 3).
    """
    form = body.points
    for number in range(_ROUNDS):
        centre = np.column_stack([np.bincount(skeleton.node_of, body.mass * form[:, axis]) for axis in range(3)])
        target = form + (places - centre / np.bincount(skeleton.node_of, body.mass)[:, None])[skeleton.node_of]
        form = body.towards(target, _PULL, _STEPS)
        monitor.tick((number + 1) / _ROUNDS)
    return form


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface by least-squares scaling of its curve skeleton, starting from its input position."""
    whole = WholeSurface(found, settings, monitor)
    with monitor.stage("Skeleton"):
        from_root = np.maximum(whole.heat.distances([whole.summit])[:, 0], 0.0)
        skeleton = curve_skeleton(whole.points, whole.faces, from_root)
        wanted = skeleton.path_lengths()
    with monitor.stage("Embedding"):
        places, history = skeleton.nodes, np.zeros(1)
        if len(skeleton.nodes) > 1:
            places, history = smacof(
                wanted,
                skeleton.nodes,
                weights=np.outer(skeleton.areas, skeleton.areas),
                max_iterations=settings.max_iterations,
                tolerance=PATIENT,
            )
    with monitor.stage("Detail"):
        form = driven(whole.body, skeleton, places, monitor)
        return MethodResult(form, history, len(skeleton.nodes) ** 2)


METHODS = (
    Method(
        name="skeleton",
        label="Skeleton",
        help="A curve skeleton is straightened and drives the mesh (Pickup and others 2016)",
        source="Pickup, Sun, Rosin and Martin 2016",
        unfold=_form,
        stages={"Skeleton": 10, "Embedding": 10, "Detail": 39},
        uses=("max_iterations",),
        rank=8,
    ),
)
