"""Figure 1: feature points under changes of the mesh, with the repeatability of each."""

import numpy as np
from matplotlib.figure import Figure

from addon.core import Settings, feature_patches
from addon.core.distance_fields import heat_geodesics
from addon.core.mesh.connectivity import component_labels
from addon.core.mesh.edges import vertex_pairs
from tests.meshes.remeshing import noisy
from tools.figures.drawing import show
from tools.figures.models import facing

NEAR = 0.05  # of the geodesic diameter: feature points at a smaller distance count as the same


def smoothed(vertices, faces, steps=20):
    i, j = vertex_pairs(faces).T
    degree = np.bincount(np.concatenate([i, j]), minlength=len(vertices))[:, None]
    for _ in range(steps):
        total = np.zeros_like(vertices)
        np.add.at(total, i, vertices[j])
        np.add.at(total, j, vertices[i])
        vertices = 0.5 * vertices + 0.5 * total / degree
    return vertices, faces


def occluded(vertices, faces, shape):
    """Return the largest piece of the surface that a camera in front sees."""
    turned = vertices @ facing(shape)
    normal = np.cross(*(turned[faces[:, k]] - turned[faces[:, 0]] for k in (1, 2)))
    seen = faces[normal[:, 2] > -0.3 * np.linalg.norm(normal, axis=1)]
    label = component_labels(len(vertices), vertex_pairs(seen))
    largest = np.argmax(np.bincount(label[seen[:, 0]]))
    kept = seen[label[seen[:, 0]] == largest]
    used, corners = np.unique(kept, return_inverse=True)
    return vertices[used], corners.reshape(-1, 3), used


def repeatability(reference, faces, base, others):
    """Return the share of both sets of feature points (vertices of the reference) with a partner in the other set."""
    far = heat_geodesics(reference, faces, base)
    near = NEAR * far.max()
    to_others = far[others]  # (others, base)
    return float(((to_others.min(axis=0) <= near).sum() + (to_others.min(axis=1) <= near).sum())
                 / (len(base) + len(others)))  # fmt: skip


def repeated(reference, faces, vertices, triangles, used=None):
    """Return the feature points of a changed mesh, and their repeatability against the reference."""
    base = feature_patches(reference, faces, Settings()).feature_points
    found = feature_patches(vertices, triangles, Settings()).feature_points
    others = found if used is None else used[found]
    return found, repeatability(reference, faces, base, others)


def draw(models):
    name = "man" if "man" in models else next(iter(models))
    poses = models[name]
    _, vertices, faces = poses[0]
    turn = facing(name)
    changed = [("as it is", vertices, faces, None), ("10 times as large", 10 * vertices, faces, None)]
    cut, cut_faces, used = occluded(vertices, faces, name)
    changed.append(("seen from the front only", cut, cut_faces, used))
    changed.append(("noise of 0.2 edges", *noisy(vertices, faces), None))
    changed.append(("smoothed 20 times", *smoothed(vertices, faces), None))
    changed += [(f"pose: {pose}", *mesh, None) for pose, *mesh in poses[1:4]]
    others = [(label, those) for label, those in models.items() if label != name]
    columns = max(len(changed) // 2 + len(changed) % 2, len(others))
    figure = Figure(figsize=(2.1 * columns, 7.4), layout="constrained")
    grid = figure.subplots(3, columns, squeeze=False)
    figures = {}
    for axes, (title, points, triangles, kept) in zip(grid[:2].ravel(), changed, strict=False):
        found, score = repeated(vertices, faces, points, triangles, kept)
        adf = feature_patches(points, triangles).adf
        show(axes, points, triangles, turn, np.log(adf), points=found, title=title,
             under=f"{len(found)} points, repeatability {score:.2f}")  # fmt: skip
        figures[title] = score
    for axes, (label, those) in zip(grid[2], others, strict=False):
        scores, counts = [], []
        for _, points, triangles in those[1:]:
            found, score = repeated(those[0][1], those[0][2], points, triangles)
            scores.append(score)
            counts.append(len(found))
        _, points, triangles = those[0]
        found = feature_patches(points, triangles)
        show(axes, points, triangles, facing(label), np.log(found.adf), points=found.feature_points, title=label,
             under=f"{len(found.feature_points)} points, in {len(scores)} poses {np.mean(scores):.2f}")  # fmt: skip
        figures[label] = float(np.mean(scores))
    for axes in grid.ravel():
        axes.set_axis_off()
    return figure, figures
