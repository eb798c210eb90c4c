"""Results for each object of a body: its part of the form, its report, its colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..mesh_items.palette import Colours, colours_of
from ..objects.combining import Combined
from ..objects.mesh_reading import Reading
from ..objects.object_warnings import NOTES, warnings_by_object
from ..records.form_report import FormReport, patch_sizes
from ..results.match_values import MatchValues
from ..words.advice import CUT, MENDS
from ..words.wording import listed, told
from .request import Request

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray
    from ...core.results import AnyResult

_ASYMMETRIC = 0.02  # units of sqrt(area): a larger distance between the halves causes a warning


class FormResult(NamedTuple):
    """Result for one object.

    Attributes
    ----------
    found : CanonicalForm, PosedLike or FeaturePatches
        The form, the pose of another object, or the patches if the request stops there, in the object's local space;
        feature points on another object of the body are -1.
    report : FormReport
        The report; writing the result adds warnings about the object.
    colours : Colours
        Colours of the fields and patches.
    shapes : list of (n, 3) ndarray of float
        Shapes between pose and form, for keys of an earlier run that are computed again.
    carried : MatchValues or None
        Values that show the match with the object that provides the pose.
    """

    found: AnyResult
    report: FormReport
    colours: Colours
    shapes: list[FloatArray]
    carried: MatchValues | None = None


def results_of(
    readings: Sequence[Reading],
    whole: Combined,
    found: AnyResult,
    shapes: Sequence[FloatArray],
    request: Request,
    carried: MatchValues | None = None,
) -> list[FormResult]:
    """Split the results for a body by object.

    Parameters
    ----------
    readings : sequence of Reading
        The objects.
    whole : Combined
        The same objects as one mesh.
    found : CanonicalForm, PosedLike or FeaturePatches
        The results for that mesh, folded.
    shapes : sequence of (n, 3) ndarray of float
        Shapes between its pose and form.
    request : Request
        What was to be computed.
    carried : MatchValues, optional
        Values that show the match with the object that provides the pose.

    Returns
    -------
    list of FormResult
        One per object. Their reports share the stress, the measures and the list of warnings.
    """
    report = _report(readings, whole, found, request)
    report.frame = readings[0].frame if report.measures else None
    colours = _colours_of(found, whole)
    if len(readings) == 1 and not readings[0].mirrors:
        return [FormResult(found, report, colours, list(shapes), carried)]
    if len(readings) > 1:
        report.objects = [each.name for each in readings]
    points = whole.owned(found.feature_points)
    shown = zip(whole.split(colours.field), whole.split(colours.patches), strict=True)
    between = [whole.brought_back(shape) for shape in shapes]
    matched: list[MatchValues | None] = [None] * len(readings)
    if carried is not None:
        matched = [MatchValues(*each) for each in zip(*map(whole.split, carried), strict=True)]
    return [
        FormResult(
            own,
            replace(
                report,
                vertices=len(reading.vertices),
                faces=len(reading.faces),
                feature_points=points[number].tolist(),
                patch_sizes=patch_sizes(own.patches, len(report.feature_points)),
            ),
            Colours(*each, colours.palette),
            [shape[number] for shape in between],
            matched[number],
        )
        for number, (reading, own, each) in enumerate(zip(readings, _split(found, readings, whole), shown, strict=True))
    ]


def folded(found: AnyResult, whole: Combined) -> AnyResult:
    """Merge the patch of a feature point on a mirror image into the patch of the original.

    Parameters
    ----------
    found : CanonicalForm, PosedLike or FeaturePatches
        The results for objects with mirror images.
    whole : Combined
        The objects as one mesh.

    Returns
    -------
    CanonicalForm, PosedLike or FeaturePatches
        The same with fewer feature points.
    """
    from ...core import CanonicalForm

    sources = np.concatenate([start + each.source for start, each in zip(whole.starts, whole.objects, strict=False)])
    points, patches = sources[found.feature_points], found.patches
    own = points == found.feature_points
    kept = np.where(own | ~own[patches[points]], np.arange(len(points)), patches[points])
    used, number = np.unique(kept, return_inverse=True)
    points, patches = points[used], np.append(number, -1)[patches]
    names = [found.feature_names[each] for each in used]
    if isinstance(found, CanonicalForm):
        return replace(found, feature_points=points, feature_names=names, patches=patches, bends=found.bends[used])
    return replace(found, feature_points=points, feature_names=names, patches=patches)


def _colours_of(found: AnyResult, whole: Combined) -> Colours:
    """Colour the fields and patches; a stance has none."""
    from ...core import Stance

    if isinstance(found, Stance):
        none = np.zeros((len(whole.vertices), 4), dtype=np.float32)
        return Colours(none, none, [])
    return colours_of(found.adf, found.patches, whole.faces)


def _split(found: AnyResult, readings: Sequence[Reading], whole: Combined) -> Sequence[AnyResult]:
    """Split forms or patches by object."""
    from ...core import FeaturePatches, Stance

    surfaces = list(
        zip(whole.owned(found.feature_points), whole.split(found.patches), whole.split(found.adf), strict=True)
    )
    if isinstance(found, FeaturePatches):
        return [replace(found, feature_points=points, patches=patches, adf=adf) for points, patches, adf in surfaces]
    forms = whole.brought_back(found.vertices)
    parts = [
        replace(found, vertices=form, faces=reading.faces, feature_points=points, patches=patches, adf=adf)
        for form, reading, (points, patches, adf) in zip(forms, readings, surfaces, strict=True)
    ]
    if not isinstance(found, Stance) and len(found.contacts):
        own = whole.split(found.contacts)
        return [replace(part, contacts=each) for part, each in zip(parts, own, strict=True)]  # type: ignore[arg-type]
    return parts


def _report(readings: Sequence[Reading], whole: Combined, found: AnyResult, request: Request) -> FormReport:
    """Create the report for a whole body."""
    from ...core import CanonicalForm, FeaturePatches, PosedLike, Stance

    report = FormReport.of(found, whole.vertices, whole.faces, request.settings, hausdorff=request.hausdorff)
    report.warnings = warnings_by_object(found.warnings, readings)
    said = list(zip(report.warnings, (each.kind for each in found.warnings), strict=True))
    report.notes = [sentence for sentence, kind in said if kind in NOTES]
    report.mends = {sentence: MENDS[kind] for sentence, kind in said if kind in MENDS}
    if isinstance(found, CanonicalForm | PosedLike) and found.contacts.any():
        shown = told("The vertex group Contacts shows where skin was parted.")
        report.warnings.append(shown)
        if len(readings) == 1:  # of several objects none is cut
            report.mends[shown] = CUT
    if isinstance(found, FeaturePatches):
        return report
    apart = max(whole.asymmetries(found.vertices))
    if apart > _ASYMMETRIC:
        report.warnings.append(
            told(
                "The halves of the mirrored mesh unfold differently, by {apart:.0%} of its size; the "
                "form is their mean.",
                apart=apart,
            )
        )
    if isinstance(found, PosedLike | Stance) and request.likeness is not None:
        report.like = request.likeness.report(found)
        rigs = sorted({each.rig for each in readings if each.rig})
        if isinstance(found, PosedLike) and rigs:
            report.warnings.append(
                told(
                    "The bones of {rig} could not give the pose: a mannequin was matched instead. Check the pose.",
                    rig=listed(rigs),
                )
            )
    return report
