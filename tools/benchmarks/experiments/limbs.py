"""Feature points, limbs and in-betweens: on folders of posed bodies, on bent limbs and on bent tubes."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from addon.core import CanonicalForm, Settings, canonical_form
from addon.core.distance_fields import heat_geodesics
from addon.core.limbs import limb_shapes
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import edge_stretch
from addon.core.mesh.edges import vertex_pairs
from addon.core.mesh.geometry import signed_volume, vertex_areas
from addon.core.posing.articulation import Articulation
from addon.core.posing.limb_amounts import limb_amounts
from tests.meshes import shapes, tubes
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import exact_distances
from tools.benchmarks.mesh_sets import Body, folders, generated, largest_pieces

HEAT_SOURCES, STRESS_STEPS = 20, 300
SIZES = {"1,618": (16, 100), "3,866": (24, 160), "7,714": (32, 240)}  # vertices of a tube: around and along


@experiment("poses", folders)
def features(body: Body, _: None) -> Iterator[Row]:
    """*farthest*: largest distance of a feature point from the nearest one in the first pose, over the geodesic
    diameter; *heat error*: mean relative error of heat geodesics against exact ones, 20 sources; *largest
    increase* of the stress of *Local Features* in one of 300 steps, never above 0.
    """
    names, poses, faces = body.poses
    settings = Settings(method="local_features", max_iterations=STRESS_STEPS)
    sources = np.random.default_rng(7).choice(len(poses[0]), HEAT_SOURCES, replace=False)
    first = None
    for name, pose in zip(names, poses, strict=True):
        form = canonical_form(pose, faces, settings)
        if first is None:
            first = heat_geodesics(pose, faces, form.feature_points)
        true = exact_distances(pose, faces, sources)
        heat, away = heat_geodesics(pose, faces, sources), true > 0
        yield {
            "pose": name,
            "features": len(form.feature_points),
            "farthest": (first / first.max())[form.feature_points].min(axis=1).max(),
            "heat error": (np.abs(heat - true)[away] / true[away]).mean(),
            "largest increase (rounding)": (np.diff(form.stress) / form.stress[:-1]).max(),
        }


@experiment("limbs", folders)
def limbs(body: Body, _: None) -> Iterator[Row]:
    """The pose removed from one limb, for every limb: edge distortion |stretch - 1| in the whole form, and in the
    band along the border of the worst limb; *moved outside*: largest displacement outside the limb and its band,
    over the size; change of volume halfway to the whole form.
    """
    names, poses, faces = body.poses
    for name, points in zip(names, poses, strict=True):
        found = canonical_form(points, faces)
        bands, outside = [], [0.0]
        for patch in range(len(found.feature_points)):
            chosen = found.patches == patch
            shape, amounts = limb_shapes(points, faces, found.vertices, chosen)[0], limb_amounts(points, faces, chosen)
            band = ((amounts > 0) & (amounts < 1))[vertex_pairs(faces)].any(axis=1)
            bands.append(np.abs(edge_stretch(points, shape, faces) - 1)[band])
            outside.append(np.abs(shape - points)[amounts == 0].max() / np.ptp(points, axis=0).max())
        yield {
            "pose": name,
            "whole form, 99 %": np.quantile(np.abs(edge_stretch(points, found.vertices, faces) - 1), 0.99),
            "worst band, 99 %": max(np.quantile(band, 0.99) for band in bands),
            "largest in a band": max(band.max() for band in bands),
            "moved outside (rounding)": max(outside),
            **halfway(points, faces, found.vertices),
        }


def halfway(points: np.ndarray, faces: np.ndarray, form: np.ndarray) -> Row:
    """Return the change of volume halfway to a form, by the in-between and by a plain blend."""
    volume = signed_volume(points, faces)
    between = Articulation(points, faces, form).at(0.5)
    return {
        "in-between": signed_volume(between, faces) / volume - 1,
        "plain blend": signed_volume((points + form) / 2, faces) / volume - 1,
    }


@experiment(
    "in-betweens",
    generated(**{f"{degrees}°": partial(shapes.joint, degrees) for degrees in (60, 90, 120, 150)}),
    settings={"": shapes.joint(0)[0]},
)
def bent_limb(body: Body, straight: np.ndarray) -> Iterator[Row]:
    """A limb bent by an angle: change of volume halfway to the same limb straight."""
    points, faces = body.first
    rotation, shift = rigid_fit(straight, points)
    yield halfway(points, faces, straight @ rotation + shift)


@experiment(
    "tubes",
    generated(**{name: partial(tubes.tube, curve, 16, 100) for name, curve in tubes.CURVES.items()}),
    settings=SIZES,
)
def tube(body: Body, size: tuple[int, int]) -> Iterator[Row]:
    """Closed tubes of length 4 and radius .12, bent in several ways. *ends*: distance between the centres of the
    end rings over the length of the form's axis; *length*: that over the input's; *girth* of a ring over the
    input's, without five rings at each end.
    """
    vertices, faces = tubes.tube(tubes.CURVES[body.name], *size)
    axis, girths = tubes.rings(canonical_form(vertices, faces).vertices, size[0])
    before, own_girths = tubes.rings(vertices, size[0])
    girth = (girths / own_girths)[5:-5]
    yield {
        "ends": np.linalg.norm(axis[-1] - axis[0]) / tubes.length_of(axis),
        "length": tubes.length_of(axis) / tubes.length_of(before),
        "girth": np.median(girth),
        "least": girth.min(),
        "most": girth.max(),
    }


def sets_of_poses(data: Path | None) -> list[Body]:
    """Return the bodies of the folders, and the largest pieces of the rigged files."""
    return [*folders(data), *largest_pieces(data)]


@experiment("sets", sets_of_poses)
def sets(body: Body, _: None) -> Iterator[Row]:
    """Poses of one mesh, of rigged files the largest piece. *numbers off*: pairs of poses in which the limb
    nearest to a feature point has another number, each form alone, and all with the first as reference; *apart*:
    distance of the forms on the reference from it, over that after the best rigid motion, the most; *upright*:
    degrees between two upright forms.
    """
    poses, faces = body.poses[1:]
    weights = vertex_areas(poses[0], faces)
    alone = [canonical_form(pose, faces, Settings(orientation="upright")) for pose in poses]
    led = [canonical_form(pose, faces, reference=alone[0]) for pose in poses]
    fits = [rigid_fit(one.vertices, two.vertices, weights)[0] for one, two in combinations(alone, 2)]
    turns = np.degrees([Rotation.from_matrix(fit).magnitude() for fit in fits])
    yield {
        "poses": len(poses),
        "numbers off": pairs_off(alone),
        "on a reference": pairs_off(led),
        "apart / best fit": max(over_best_fit(form.vertices, alone[0].vertices, weights) for form in led[1:]),
        "upright, median": np.median(turns),
        "upright, most": max(turns),
    }


def over_best_fit(form: np.ndarray, reference: np.ndarray, weights: np.ndarray) -> float:
    """Return how far a form is from its reference, over the same after the best rigid motion."""
    rotation, shift = rigid_fit(form, reference, weights)
    offs = (((points - reference) ** 2).sum(axis=1) for points in (form, form @ rotation + shift))
    written, best = (np.sqrt(weights @ off) for off in offs)
    return float(written / best)


def pairs_off(forms: Sequence[CanonicalForm]) -> str:
    """Count pairs of poses in which the limb nearest to a feature point has another number."""
    pairs = list(combinations(forms, 2))
    off = 0
    for one, other in pairs:
        here, there = one.vertices[one.feature_points], one.vertices[other.feature_points]
        nearest = np.linalg.norm(here[:, None] - there, axis=2).argmin(axis=1)
        off += bool((nearest != np.arange(len(here))).any())
    return f"{off} of {len(pairs)}"
