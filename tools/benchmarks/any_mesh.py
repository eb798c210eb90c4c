"""Runs this project and four libraries on families of meshes, one process each: ``any_mesh.py [NAME …]``.

The task is to compute distances from one vertex (for robust_laplacian the lowest eigenvalues). A result is *right* if
all distances on the part of that vertex are finite, none exceeds the path along edges by more than 5 % of the largest,
none is below the straight distance by more, and those on other parts are not finite; for eigenvalues, if there are as
many zeros as parts. *Wrong* states the reason; *refused* is an error message; *crash* is the end of the process.
Prints rows of the table in docs/any-mesh.md.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.meshes.families import families  # noqa: E402

LIBRARIES = ("ours", "potpourri3d", "pygeodesic", "libigl", "robust_laplacian")
PATIENCE = 20


def along_edges(vertices, faces, source):
    """Measure distances along the edges of the mesh; vertices at the same position are joined."""
    from scipy.sparse.csgraph import dijkstra

    _, place = np.unique(vertices, axis=0, return_inverse=True)
    pairs = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    pairs = pairs[(pairs[:, 0] != pairs[:, 1])]
    length = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
    graph = _least(pairs, place.ravel(), length)
    return dijkstra(graph, directed=False, indices=place.ravel()[source])[place.ravel()]


def _least(pairs, place, length):
    """Keep the shortest edge between each pair of positions."""
    from scipy.sparse import coo_matrix

    ends = np.sort(place[pairs], axis=1)
    order = np.lexsort((length, ends[:, 1], ends[:, 0]))
    ends, length = ends[order], length[order]
    first = np.concatenate([[True], (ends[1:] != ends[:-1]).any(axis=1)])
    count = int(place.max()) + 1
    return coo_matrix((length[first] + 1e-300, ends[first].T), shape=(count, count)).tocsr()


def distances(library, vertices, faces, source):
    """Compute distances with a library."""
    if library == "ours":
        from addon.core.distance_fields import heat_geodesics

        return heat_geodesics(vertices, faces, source)[:, 0]
    if library == "potpourri3d":
        import potpourri3d

        return potpourri3d.MeshHeatMethodDistanceSolver(vertices, faces).compute_distance(source)
    if library == "pygeodesic":
        from pygeodesic import geodesic

        return geodesic.PyGeodesicAlgorithmExact(vertices, faces).geodesicDistances(np.array([source]), None)[0]
    import igl

    none, all_vertices = np.empty(0, int), np.arange(len(vertices))
    return np.asarray(igl.exact_geodesic(vertices, faces, np.array([source]), none, all_vertices, none))


def judged(library, name):
    """Describe the result of a library on a family in a few words."""
    family = families()[name]
    vertices, faces = np.ascontiguousarray(family.vertices), np.ascontiguousarray(family.faces, dtype=np.int64)
    if library == "ours" and not family.refused:
        from addon.core import canonical_form

        form = canonical_form(vertices, faces)
        if not np.isfinite(form.vertices).all():
            return "wrong: form not finite"
    source = int(faces[0, 0]) if len(faces) else 0
    if library == "robust_laplacian":
        return eigenvalues_judged(vertices, faces)
    found = np.asarray(distances(library, vertices, faces, source), dtype=float).ravel()
    if family.refused:
        return "wrong: an answer without a surface" if np.isfinite(found).all() else "not finite"
    upper = along_edges(vertices, faces, source)
    here = np.isfinite(upper)
    largest = upper[here].max()
    straight = np.linalg.norm(vertices - vertices[source], axis=1)
    if len(found) != len(vertices) or not np.isfinite(found[here]).all():
        return "wrong: not finite"
    if np.isfinite(found[~here]).any() and not (found[~here] >= 1e30).all():
        return "wrong: finite where unreachable"
    high, low = (found - upper)[here].max() / largest, (straight - found)[here].max() / largest
    if max(high, low) > 0.05:
        return f"wrong by {max(high, low):.0%}"
    return "right"


def eigenvalues_judged(vertices, faces):
    """Compare the number of zeros among the lowest eigenvalues of robust_laplacian with the number of parts."""
    import robust_laplacian
    from scipy.sparse.linalg import eigsh

    from addon.core.mesh.connectivity import component_labels
    from addon.core.mesh.edges import vertex_pairs

    L, M = robust_laplacian.mesh_laplacian(vertices, faces)
    parts = int(component_labels(len(vertices), vertex_pairs(faces)).max()) + 1
    if len(vertices) < 12:
        return "right" if np.isfinite(L.data).all() else "wrong: not finite"
    values = eigsh(L, k=min(parts + 5, len(vertices) - 2), M=M, sigma=-1e-8 * abs(L).max() / M.max(), which="LM")[0]
    zeros = int(np.count_nonzero(np.abs(values) < 1e-6 * np.abs(values).max()))
    return "right" if zeros == parts else f"wrong: {zeros} zero eigenvalues, {parts} parts"


def main(*names):
    for name, family in families().items():
        if names and name not in names:
            continue
        row = [name, f"{len(family.vertices):,}"]
        for library in LIBRARIES:
            words = [sys.executable, __file__, "one", library, name]
            try:
                done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, cwd=ROOT)
            except subprocess.TimeoutExpired:
                row.append(f"timeout ({PATIENCE} s)")
                continue
            if done.returncode < 0:
                row.append(f"**crash** ({done.returncode})")
            elif done.returncode:
                row.append("**crash**")
            else:
                row.append(json.loads(done.stdout.splitlines()[-1]))
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    np.seterr(all="ignore")
    if sys.argv[1:2] == ["one"]:
        try:
            answer = judged(*sys.argv[2:])
        except Exception as error:  # the message of the library is the result
            answer = "refused" if str(error).strip() else f"refused ({type(error).__name__})"
            if sys.argv[2] == "ours" and not type(error).__module__.startswith("addon"):
                answer = f"wrong: {type(error).__name__}"
        print(json.dumps(answer))
    else:
        main(*sys.argv[1:])
