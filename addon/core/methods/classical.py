"""Classical multidimensional scaling of geodesic distances (Elad and Kimmel)."""

from __future__ import annotations

import numpy as np

from ..embedding.classical_scaling import classical_scaling, landmark_scaling
from ..numerics.arrays import FloatArray
from ..run.errors import SolverError
from ..run.monitor import Monitor
from ..unfolding.embedding import Embedding
from ..unfolding.samples import Samples, WholeSurface
from ..unfolding.settings import Settings

_DENSE = 400  # points up to which all eigenvectors are computed


def leading_scaling(distances: FloatArray, dimensions: int = 3) -> FloatArray:
    """Embed a full matrix of distances by classical scaling, with no more eigenvectors than are needed.

    Parameters
    ----------
    distances : (n, n) ndarray of float
        Distances, symmetric.
    dimensions : int
        Dimension d of the embedding.

    Returns
    -------
    (n, d) ndarray of float
        The points, centred, along their principal axes; the sign of each axis is arbitrary.

    Raises
    ------
    SolverError
        If the axes cannot be found.

    References
    ----------
    Torgerson, "Multidimensional scaling: I. Theory and method", 1952; paper, equation 4.
    """
    from scipy.sparse.linalg import ArpackError, eigsh

    count = len(distances)
    if count <= _DENSE:
        return classical_scaling(distances, dimensions)[0]
    gram = distances**2
    mean = gram.mean(axis=1)
    gram -= mean[:, None]
    gram -= mean - mean.mean()
    gram *= -0.5  # G = -½ J D² J
    begin = np.sin(np.arange(1.0, count + 1))  # any fixed vector that is not the constant one
    try:
        values, vectors = eigsh(gram, k=dimensions, which="LA", v0=begin)
    except ArpackError as error:
        raise SolverError(
            "Classical scaling found no axes: the distances are too alike or too irregular. Clean the mesh up (Mesh > "
            "Clean Up > Merge by Distance)."
        ) from error
    order = np.argsort(-values)
    return vectors[:, order] * np.sqrt(np.maximum(values[order], 0.0))


def scaled_classically(samples: Samples) -> FloatArray:
    """Embed all vertices: from all pairs where there are all, otherwise by the landmarks.

    Parameters
    ----------
    samples : Samples
        Geodesic distances.

    Returns
    -------
    (n, 3) ndarray of float
        The points, centred.
    """
    if samples.complete:
        return leading_scaling(samples.distances)
    embedding = landmark_scaling(samples.distances, samples.vertices)
    return embedding - embedding.mean(axis=0)


def classical_form(whole: WholeSurface, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by classical scaling of its geodesic distances.

    Parameters
    ----------
    whole : WholeSurface
        The mesh.
    settings : Settings
        At quality 'full' all pairs are used, otherwise landmarks carry the rest (landmark MDS).
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    Embedding
        The form; its history is the stress of the samples.

    Raises
    ------
    TooLargeError
        If all pairs do not fit into the memory limit.
    CancelledError
        If the monitor says so.

    References
    ----------
    Elad and Kimmel, "On bending invariant signatures for surfaces", 2003; De Silva and Tenenbaum, "Sparse
    multidimensional scaling using landmark points", 2004.
    """
    with monitor.stage("Distances", 0.8):
        samples = whole.samples()
    with monitor.stage("Embedding", 0.95):
        form = scaled_classically(samples)
        monitor.check()
        return whole.embedding(form, [plain_stress(form[samples.vertices], samples.between)], samples.distances.size)


def plain_stress(points: FloatArray, distances: FloatArray) -> float:
    """Sum the squared differences between straight and wanted distances over all pairs.

    Parameters
    ----------
    points : (n, d) ndarray of float
        The points.
    distances : (n, n) ndarray of float
        Wanted distances.

    Returns
    -------
    float
        ``Σ_{i<j} (δ_ij - d_ij)²``.
    """
    from scipy.spatial.distance import pdist, squareform

    return float(((pdist(points) - squareform(distances, checks=False)) ** 2).sum())
