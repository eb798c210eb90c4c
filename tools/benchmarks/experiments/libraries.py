"""Any mesh: this project and three libraries on the families of meshes, each in a process of its own."""

import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from addon.core import CanonicalFormError, canonical_form
from addon.core.distance_fields import heat_geodesics
from tests.meshes.families import families
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import Lost, in_own_process
from tools.benchmarks.mesh_sets import Body, generated

LIBRARIES = {"ours": "numpy", "potpourri3d": "potpourri3d", "pygeodesic": "pygeodesic", "libigl": "igl"}
PATIENCE = 20.0


def every_family(data: Path | None) -> list[Body]:
    meshes = {name: (family.vertices, family.faces) for name, family in families().items()}
    return generated(**{name: lambda mesh=mesh: mesh for name, mesh in meshes.items()})(data)


@experiment("any-mesh", every_family)
def verdicts(body: Body, _: None) -> Iterator[Row]:
    """Distances from one vertex on defective meshes. *right*: finite on the part of the vertex and nowhere else, and
    between the straight distance and the path along edges, with 5 %; *refused*: an error with a message; *crash*: the
    process ended; a timeout is 20 s.
    """
    cells: Row = {"vertices": len(body.first[0])}
    for library, module in LIBRARIES.items():
        if find_spec(module) is None:
            print(f"any-mesh does not compare with {library}: pip install {library}", file=sys.stderr)
            continue
        try:
            cells[library] = in_own_process(verdict, library, body.name, patience=PATIENCE)
        except Lost as lost:
            cells[library] = f"**{lost}**" if str(lost).startswith("crash") else str(lost)
    yield cells


def verdict(library: str, name: str) -> str:
    """Say in a few words what a library makes of a family; an error with a message is a refusal."""
    family = families()[name]
    vertices, faces = np.ascontiguousarray(family.vertices), np.ascontiguousarray(family.faces, dtype=np.int64)
    np.seterr(all="ignore")
    try:
        if library == "ours" and not family.refused and not np.isfinite(canonical_form(vertices, faces).vertices).all():
            return "wrong: form not finite"
        source = int(faces[0, 0]) if len(faces) else 0
        found = np.asarray(distances(library, vertices, faces, source), dtype=float).ravel()
    except Exception as error:  # the message of the library is the result
        if library == "ours" and not isinstance(error, CanonicalFormError):
            return f"wrong: {type(error).__name__}"
        return "refused" if str(error).strip() else f"refused ({type(error).__name__})"
    if family.refused:
        return "wrong: an answer without a surface" if np.isfinite(found).all() else "not finite"
    upper = along_edges(vertices, faces, source)
    here, straight = np.isfinite(upper), np.linalg.norm(vertices - vertices[source], axis=1)
    if len(found) != len(vertices) or not np.isfinite(found[here]).all():
        return "wrong: not finite"
    if np.isfinite(found[~here]).any() and not (found[~here] >= 1e30).all():
        return "wrong: finite where unreachable"
    worst = max((found - upper)[here].max(), (straight - found)[here].max()) / upper[here].max()
    return f"wrong by {worst:.0%}" if worst > 0.05 else "right"


def distances(library: str, vertices: np.ndarray, faces: np.ndarray, source: int) -> np.ndarray:
    """Compute distances from a vertex with a library."""
    if library == "ours":
        return heat_geodesics(vertices, faces, source)[:, 0]
    if library == "potpourri3d":
        import potpourri3d

        return potpourri3d.MeshHeatMethodDistanceSolver(vertices, faces).compute_distance(source)
    if library == "pygeodesic":
        from pygeodesic import geodesic

        return geodesic.PyGeodesicAlgorithmExact(vertices, faces).geodesicDistances(np.array([source]), None)[0]
    import igl

    none = np.empty(0, int)
    return igl.exact_geodesic(vertices, faces, np.array([source]), none, np.arange(len(vertices)), none)


def along_edges(vertices: np.ndarray, faces: np.ndarray, source: int) -> np.ndarray:
    """Measure distances along the edges of the mesh; vertices at the same position are joined."""
    place = np.unique(vertices, axis=0, return_inverse=True)[1].ravel()
    pairs = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    length = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
    order = np.argsort(length, kind="stable")  # of several between two positions, the shortest
    ends, first = np.unique(np.sort(place[pairs[order]], axis=1), axis=0, return_index=True)
    count = int(place.max()) + 1
    graph = coo_matrix((length[order][first] + 1e-300, ends.T), shape=(count, count)).tocsr()
    return dijkstra(graph, directed=False, indices=place[source])[place]
