"""How far heat geodesics are from exact ones, by how good the triangles are."""

from collections.abc import Iterator

import numpy as np

from addon.core import mannequin
from addon.core.distance_fields import heat_geodesics
from addon.core.mesh.geometry import vertex_normals
from addon.core.surface.triangulation import corner_lengths, face_areas
from tests.meshes.families import torus
from tests.meshes.remeshing import resized
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import exact_distances
from tools.benchmarks.mesh_sets import Body, generated

Mesh = tuple[np.ndarray, np.ndarray]
SOURCES, NEAREST = 12, 0.1  # vertices to measure from; share of the farthest distance below which none is compared
THIN = 0.3  # quality below which a triangle is thin
BODY = 8_000  # vertices


def even() -> Mesh:
    """The mannequin, evenly meshed."""
    return resized(*mannequin(), BODY)


def jittered(share: float) -> Mesh:
    """The same with every vertex moved along the surface, by up to a share of the mean edge."""
    vertices, faces = even()
    edge = corner_lengths(vertices, faces).mean()
    way = np.random.default_rng(3).uniform(-share * edge, share * edge, vertices.shape)
    normals = vertex_normals(vertices, faces)
    return vertices + way - np.sum(way * normals, axis=1, keepdims=True) * normals, faces


def speared(share: float) -> Mesh:
    """The same surface with a vertex in every triangle, at a share of the way from its middle to a corner."""
    vertices, faces = even()
    corner = np.random.default_rng(4).integers(3, size=len(faces))
    middle, end = vertices[faces].mean(axis=1), vertices[faces[np.arange(len(faces)), corner]]
    added = middle + share * (end - middle)
    new = np.arange(len(faces)) + len(vertices)
    a, b, c = faces.T
    return np.concatenate([vertices, added]), np.concatenate(
        [np.stack([a, b, new], 1), np.stack([b, c, new], 1), np.stack([c, a, new], 1)]
    )


MESHES = generated(
    even=even,
    jittered=lambda: jittered(0.3),
    jittered_more=lambda: jittered(0.6),
    speared=lambda: speared(0.5),
    speared_more=lambda: speared(0.9),
    speared_most=lambda: speared(0.98),
    rings=lambda: torus(300, 20),
)


@experiment("heat", MESHES)
def heat(body: Body, _: None) -> Iterator[Row]:
    """Heat geodesics against exact ones (pygeodesic), 12 sources, at vertices farther than a tenth of the farthest.
    *Quality* of a triangle: 1 if it is equilateral, 0 without area, mean; *thin*: share of the triangles below .3. The
    mannequin, evenly meshed; the same with its vertices moved along the surface, and with a vertex more in every
    triangle, near a corner; and a torus of long triangles.
    """
    vertices, faces = body.first
    lengths = corner_lengths(vertices, faces)
    quality = 4 * np.sqrt(3) * face_areas(lengths) / np.sum(lengths**2, axis=1)
    sources = np.linspace(0, len(vertices) - 1, SOURCES).round().astype(np.int64)
    true = exact_distances(vertices, faces, sources)
    far = true > NEAREST * true.max(axis=0)
    error = np.abs(heat_geodesics(vertices, faces, sources) - true)[far] / true[far]
    yield {
        "vertices": len(vertices),
        "quality": quality.mean(),
        "thin": (quality < THIN).mean(),
        "mean error": error.mean(),
        "95 %": np.quantile(error, 0.95),
        "most": error.max(),
    }
