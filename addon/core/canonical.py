"""The main door: from a mesh to its canonical form, in the order of the paper."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .assembly.bodies import Chosen
from .assembly.body import Body
from .method_api.catalogue import method_named
from .method_api.method_result import MethodResult
from .method_api.settings import Settings
from .method_api.surface_features import DETECTION
from .numerics.arrays import FloatArray
from .opening import OPENING, Found, body_limbs, features_of, opened
from .placing import ReferenceBody, in_place, reference_bodies
from .results import CanonicalForm
from .run.kept_stages import KeptStages
from .run.monitor import Cancelled, Monitor, Progress
from .symmetry.limbs import Limbs


def canonical_form(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    *,
    reference: CanonicalForm | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    keep: KeptStages | None = None,
) -> CanonicalForm:
    """Compute the canonical form of a posed mesh: its shape with the pose taken out.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces, with or without borders, in any state that docs/any-mesh.md lists.
    settings : Settings, optional
        Options.
    reference : CanonicalForm, optional
        A form of the same mesh in another pose, or of another mesh of a like body. The form is laid onto it by a proper
        rotation and shift, and its limbs are numbered as there.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.
    keep : KeptStages, optional
        Hand the same object to several runs on one mesh, one after the other: each computes what changed only.

    Returns
    -------
    CanonicalForm
        The form, feature points, patches and figures.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point given by hand is not a vertex of a surface, or is given twice, or the reference has no
        feature points.
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If `cancelled` returned True.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> form = canonical_form(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> form.vertices.shape
    (4, 3)

    References
    ----------
    "Local Feature-Based 3D Canonical Form".
    """
    settings = settings or Settings()
    method = method_named(settings.method)
    settings = method.settings(settings)
    monitor = Monitor(progress, cancelled, OPENING, keep)
    bodies = opened(vertices, faces, settings, monitor)

    others: list[ReferenceBody | None] = [None] * len(bodies.bodies)
    if reference is not None:
        others = reference_bodies(reference, bodies.faces, [body.vertices for body in bodies.bodies], monitor)

    def work(
        body: Body, chosen: Chosen | None, other: ReferenceBody | None, own: Monitor
    ) -> tuple[Found, Limbs, FloatArray, MethodResult]:
        found = features_of(body, chosen, settings, own)
        embedded = method.unfold(found, settings, own)
        with own.stage("Alignment"):
            form, order = in_place(embedded, found, settings, other, own)
            shown = own.kept("shown", [found, order], lambda: found.prolonged(own, order))
            return shown, found.limbs.sorted_by(order), form, embedded

    plan = {**DETECTION, **method.stages, "Alignment": 1}
    results = bodies.map(work, monitor, plan, bodies.chosen, others)
    histories = [embedded.history for *_, embedded in results]
    steps = max(map(len, histories))  # each stays at its end value once it has ended
    pair_count = sum(embedded.pair_count for *_, embedded in results)
    found_on_each = [found for found, *_ in results]
    return CanonicalForm(
        bodies.shaped([form for _, _, form, _ in results], monitor, area_kept=True),
        bodies.faces,
        *bodies.gathered_features(found_on_each),
        np.sum([np.pad(each, (0, steps - len(each)), mode="edge") for each in histories], axis=0),
        pair_count,
        1 - pair_count / len(bodies.vertices) ** 2,
        monitor.timings,
        monitor.warnings,
        float(np.fmax.reduce([embedded.asymmetry for *_, embedded in results])),
        body_limbs(bodies, found_on_each, [limbs for _, limbs, *_ in results]),
    )
