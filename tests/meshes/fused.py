"""Figures whose skin has grown together: thickened until parts that are near become one surface."""

import numpy as np
from scipy.spatial import cKDTree

from addon.core import mannequin
from addon.core.fused.parting import capped, laid_open
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area, vertex_normals
from addon.core.modelling.surface_nets import surface_net


def fused_figure(arms, grown, step=0.02):
    """The mannequin with its arms lowered by some degrees, thickened by metres; also the vertex that each came from.

    Also the same thickness without any contact: vertices of the mannequin, moved out.
    """
    vertices, faces = mannequin(arms)
    normals = vertex_normals(vertices, faces)
    tree = cKDTree(vertices)
    low, high = vertices.min(axis=0) - 0.08, vertices.max(axis=0) + 0.08
    axes = [np.arange(start, end + step, step) for start, end in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    distance, near = tree.query(grid.reshape(-1, 3))
    outside = np.einsum("ij,ij->i", grid.reshape(-1, 3) - vertices[near], normals[near]) > 0
    field = (np.where(outside, distance, -distance) - grown).reshape(grid.shape[:3])
    points, triangles = surface_net(field, axes)
    return points, triangles, tree.query(points)[1]


def parted(vertices, faces, gone, places, cut=()):
    """A mesh parted along triangles and edges, and capped, as contacts are."""
    unit = float(np.sqrt(surface_area(vertices, faces)))
    mesh = laid_open(vertices, faces, gone, np.reshape(cut, (-1, 2)).astype(np.int64), unit)
    return capped(mesh, places[mesh.origin], unit)


def apart(form, truth, areas):
    """Distance after a rigid fit, root mean square by area."""
    rotation, shift = rigid_fit(form, truth, areas)
    return float(np.sqrt(areas @ ((form @ rotation + shift - truth) ** 2).sum(axis=1) / areas.sum()))
