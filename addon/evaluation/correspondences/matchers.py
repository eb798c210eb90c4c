"""The compared methods of matching two meshes: ours, nearest points of the forms, and functional maps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from ...core import InvalidSettingsError, canonical_form, pose_like
from ...core.measures.alignment import closest_point_fit
from ...core.mesh.closest_points import closest_points
from ...core.mesh.geometry import surface_area
from ...core.numerics.arrays import FloatArray, IntArray

_EIGENPAIRS, _ROUNDS, _STEP = 30, 16, 5  # of functional maps and their refinement, as pyFM's documentation advises
_WEIGHTS = {"w_descr": 1.0, "w_lap": 0.1, "w_dcomm": 1.0, "w_orient": 1.0}


class Mesh(NamedTuple):
    """A mesh.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.
    """

    vertices: FloatArray
    faces: IntArray


class Found(NamedTuple):
    """For every vertex of a mesh, a point on another mesh; and the transferred pose, if the method provides it.

    Attributes
    ----------
    corners : (n, 3) ndarray of int
        Vertices of the other mesh.
    weights : (n, 3) ndarray of float
        Their weights.
    posed : (n, 3) ndarray of float or None
        The mesh in the pose of the other.
    edges : float or None
        Median change of its edge lengths.
    """

    corners: IntArray
    weights: FloatArray
    posed: FloatArray | None = None
    edges: float | None = None


@dataclass(frozen=True)
class Matcher:
    """A method of matching.

    Attributes
    ----------
    name : str
        Name in tables and on the command line.
    source : str
        Its origin.
    match : callable
        The function: two `Mesh` to `Found`.
    packages : tuple of str
        Modules that it needs besides numpy and scipy.
    """

    name: str
    source: str
    match: Callable[[Mesh, Mesh], Found]
    packages: tuple[str, ...] = ()


def by_this_project(one: Mesh, other: Mesh) -> Found:
    """Match with this project, and transfer the pose.

    Parameters
    ----------
    one, other : Mesh
        The meshes.

    Returns
    -------
    Found
        The match and the pose.
    """
    posed = pose_like(*one, *other)
    found = posed.match
    return Found(found.other_faces[found.faces], found.weights, posed.vertices, posed.edge_distortion)


def by_nearest(one: Mesh, other: Mesh) -> Found:
    """Align one form to the other by closest points, from many starts, and match nearest points.

    Parameters
    ----------
    one, other : Mesh
        The meshes.

    Returns
    -------
    Found
        The match.
    """
    forms = [canonical_form(*mesh) for mesh in (one, other)]
    here, there = (form.vertices / np.sqrt(surface_area(form.vertices, form.faces)) for form in forms)
    rotation, shift = closest_point_fit(here, there)
    faces = forms[1].faces
    at = closest_points(there, faces, here @ rotation + shift)
    return Found(faces[at.faces], at.weights)


def by_functional_maps(one: Mesh, other: Mesh) -> Found:
    """Match by functional maps of wave kernel signatures, refined by ZoomOut, with pyFM as its documentation advises.

    Parameters
    ----------
    one, other : Mesh
        The meshes.

    Returns
    -------
    Found
        The match, with vertices.

    References
    ----------
    https://github.com/RobinMagnet/pyFM; Melzi and others, "ZoomOut", 2019, doi:10.1145/3355089.3356524.
    """
    from pyFM.functional import FunctionalMapping
    from pyFM.mesh import TriMesh

    source, target = (TriMesh(*mesh, area_normalize=True, center=True) for mesh in (other, one))
    model = FunctionalMapping(source, target)
    model.preprocess(descr_type="WKS", subsample_step=2)
    model.fit(K=_EIGENPAIRS, **_WEIGHTS)
    nearest = np.asarray(model.get_p2p(model.zoomout_refine(nit=_ROUNDS, step=_STEP)))
    weights = np.zeros((len(nearest), 3))
    weights[:, 0] = 1.0
    return Found(np.repeat(nearest[:, None], 3, axis=1), weights)


MATCHERS = {
    each.name: each
    for each in (
        Matcher("ours", "this project, default", by_this_project),
        Matcher("nearest", "this project's forms, laid onto each other by closest points", by_nearest),
        Matcher("pyfm", "pyFM: functional maps of wave kernel signatures, ZoomOut", by_functional_maps, ("pyFM",)),
    )
}


def installed() -> list[str]:
    """Return the methods whose packages are installed.

    Returns
    -------
    list of str
        Names of the methods.
    """
    return [each.name for each in MATCHERS.values() if all(map(find_spec, each.packages))]


def chosen_matchers(names: Sequence[str]) -> list[Matcher]:
    """Look up methods of matching.

    Parameters
    ----------
    names : sequence of str
        Their names.

    Returns
    -------
    list of Matcher
        The methods, each once.

    Raises
    ------
    InvalidSettingsError
        If a name is unknown, or there is none.
    """
    unknown = [name for name in names if name not in MATCHERS]
    if unknown or not names:
        word = repr(unknown[0]) if unknown else "nothing"
        raise InvalidSettingsError(f"There is no way to match {word}. There are: {', '.join(MATCHERS)}.")
    return [MATCHERS[name] for name in dict.fromkeys(names)]
