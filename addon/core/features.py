"""Entry point for feature points and patches only."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from .assembly.body import Body, Chosen
from .assembly.gathering import gathered_features
from .assembly.opening import OPENING, opened
from .method_api.catalogue import DETECTION, method_named
from .method_api.settings import AnySettings, settings_from
from .numerics.arrays import FloatArray
from .results import FeaturePatches
from .run.monitor import Cancelled, Monitor, Progress
from .symmetry.limb_names import limb_names, side_of

if TYPE_CHECKING:
    from .method_api.surface_features import WholeFeatures


def feature_patches(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: AnySettings = None,
    *,
    rest: ArrayLike | None = None,
    named: bool = False,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    **options: Any,
) -> FeaturePatches:
    """Find the feature points and patches of a mesh, without computing its form.

    Parameters
    ----------
    vertices, faces, settings, rest, progress, cancelled, **options
        As in `canonical_form`.
    named : bool
        Whether bodies whose surface hardly tells left from right, as that of a person, are unfolded to name their
        limbs; that takes as long as a form.

    Returns
    -------
    FeaturePatches
        The same as `canonical_form` finds.

    Raises
    ------
    CanonicalFormError
        As in `canonical_form`.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> found = feature_patches(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> len(found.patches), len(found.feature_points) > 0
    (4, True)

    References
    ----------
    The paper, section 4.
    """
    from .placing.orientation import names_in_form
    from .symmetry.upright import SURELY

    settings = settings_from(settings, options)
    method = method_named(settings.method)
    settings = method.settings(settings)
    monitor = Monitor(progress, cancelled, OPENING)
    bodies = opened(vertices, faces, settings, monitor, rest=rest)

    def work(body: Body, chosen: Chosen | None, own: Monitor) -> tuple[WholeFeatures, list[str], FloatArray]:
        found = body.features(chosen, settings, own)
        names = limb_names(found.limbs)
        if named and any(map(side_of, names)) and found.limbs.told < SURELY:
            names = names_in_form(method.unfold(found, settings, own), found)
        return found.prolonged(own), names, found.spectrum.eigenvalues

    plan = {**DETECTION, **method.stages} if named else DETECTION
    features, names, spectra = zip(*bodies.map(work, monitor, plan, bodies.chosen), strict=True)
    found, warnings = gathered_features(bodies, features), monitor.warnings
    eigenvalues = spectra[bodies.largest_body].copy()
    return FeaturePatches(
        found.points,
        found.patches,
        found.adf,
        monitor.timings,
        warnings,
        found.bodies,
        eigenvalues,
        found.numbered(names),
    )
