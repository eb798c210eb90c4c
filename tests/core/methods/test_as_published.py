"""Readings of the paper: every formula once more, pair by pair, from the printed page."""

import numpy as np
import pytest

from addon.core import CancelledError, Settings, TooLargeError, canonical_form
from addon.core.distances.patch_geodesics import all_geodesics
from addon.core.embedding.smacof import smacof
from addon.core.mesh.geometry import surface_area
from addon.core.method_api.catalogue import method_named
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes
from tests.meshes.shapes import Mesh

BOTH = ("as_published", "as_published_closed")


@pytest.fixture(scope="module")
def mesh():
    return shapes.figure(13)


def spectrum_of(points, faces):
    surface = intrinsic_delaunay(triangulated(points, faces))
    return compute_spectrum(stiffness(surface), mass(surface), 80)


def squared(spectrum, points, power):
    """Σ (h_k(i) - h_k(j))² / λ_k^power over the 80 eigenpairs: equation 8 for 1 and equation 9 for 2."""
    h = spectrum.eigenvectors[points]
    return ((h[:, None] - h) ** 2 / spectrum.eigenvalues**power).sum(axis=2)


@pytest.mark.parametrize("method", BOTH)
def test_stress_is_equation_10_with_truncated_sums_and_bare_terms(mesh, method):
    vertices, faces = mesh
    points = (vertices - vertices.mean(axis=0)) / np.sqrt(surface_area(vertices, faces))
    form = canonical_form(vertices, faces, Settings(method=method, start="input", max_iterations=0))
    spectrum, features = spectrum_of(points, faces), form.feature_points
    decay = np.exp(-0.1 * spectrum.eigenvalues / spectrum.eigenvalues[0])
    np.testing.assert_allclose(form.adf, spectrum.eigenvectors**2 @ decay, rtol=1e-9)  # equation 7, t = 0.1
    total, pair_count = 0.0, len(features) ** 2
    for index in range(len(features)):
        members, corners = np.unique(faces[(form.patches[faces] == index).any(axis=1)], return_inverse=True)
        delta = all_geodesics(triangulated(points[members], corners.reshape(-1, 3)))
        if method == "as_published":
            own = np.flatnonzero(form.patches[members] == index)
            delta, members = delta[np.ix_(own, own)], members[own]
        apart = np.linalg.norm(points[members][:, None] - points[members], axis=2)
        upper = np.triu_indices(len(members), 1)
        weight = squared(spectrum, members, 1)[upper] / delta[upper] ** 2
        total += (weight * (delta[upper] - apart[upper]) ** 2).sum()
        pair_count += len(members) ** 2
    biharmonic = np.sqrt(squared(spectrum, features, 2))
    heat = form.adf[features] + 1  # as printed: equation 7 from 0, exp(0) h_0² on a unit area
    for i in range(len(heat)):
        for j in range(i + 1, len(heat)):
            apart = np.linalg.norm(points[features[i]] - points[features[j]])
            total += (heat[i] + heat[j]) / 2 * (biharmonic[i, j] - apart) ** 2
    assert form.stress[0] == pytest.approx(total, rel=1e-9)
    assert form.pair_count == pair_count


def test_open_cells_share_no_vertex(mesh: Mesh):
    form = canonical_form(*mesh, Settings(method="as_published", max_iterations=0))
    assert form.pair_count == (np.bincount(form.patches) ** 2).sum() + len(form.feature_points) ** 2


@pytest.mark.parametrize("method", BOTH)
def test_it_starts_at_the_input_or_at_its_classical_embedding(mesh, method):
    vertices, faces = mesh
    form = canonical_form(vertices, faces, Settings(method=method, start="input", max_iterations=0))
    np.testing.assert_allclose(form.vertices, vertices, atol=1e-9)
    assert len(form.stress) == 1
    ends = [int(end) for end in form.feature_points]
    form = canonical_form(vertices, faces, Settings(method=method, feature_points=ends, max_iterations=0))
    scaled = canonical_form(vertices, faces, Settings(method="classical", feature_points=ends))
    np.testing.assert_allclose(form.vertices, scaled.vertices, atol=1e-6 * np.ptp(vertices))


def test_what_the_paper_leaves_open_changes_the_weights_and_nothing_else(mesh: Mesh):
    """A scaled dB changes the sum over feature points by what the formula says, whichever weights the patches have."""
    stress = {}
    for weight in ("squared", "plain"):
        for scale in ("own", "geodesic"):
            settings = Settings(
                method="as_published", start="input", pair_weight=weight, biharmonic_scale=scale, max_iterations=0
            )
            stress[weight, scale] = canonical_form(*mesh, settings)
    vertices, faces = mesh
    points = (vertices - vertices.mean(axis=0)) / np.sqrt(surface_area(vertices, faces))
    features, spectrum = stress["squared", "own"].feature_points, spectrum_of(points, faces)
    geodesic = all_geodesics(intrinsic_delaunay(triangulated(points, faces)))[np.ix_(features, features)]
    apart = np.linalg.norm(points[features][:, None] - points[features], axis=2)
    heat = stress["squared", "own"].adf[features] + 1
    own = np.sqrt(squared(spectrum, features, 2))
    long = own * (own * geodesic).sum() / (own**2).sum()
    mean = (heat[:, None] + heat) / 2
    change = (mean * ((long - apart) ** 2 - (own - apart) ** 2)).sum() / 2
    for weight in ("squared", "plain"):
        told = stress[weight, "geodesic"].stress[0] - stress[weight, "own"].stress[0]
        assert told == pytest.approx(change, rel=0.02)  # geodesics there are measured on finer triangles
    assert stress["plain", "own"].stress[0] != pytest.approx(stress["squared", "own"].stress[0], rel=0.01)


def test_one_patch_is_scaled_by_smacof():
    """A sphere is one patch: its form is that of SMACOF from the input, at its own scale, which no area changes."""
    vertices, faces = shapes.sphere(2)
    points = vertices * [1.0, 1.1, 1.2]
    points = (points - points.mean(axis=0)) / np.sqrt(surface_area(points, faces))
    settings = Settings(method="as_published", start="input", feature_points=[7], max_iterations=12)
    form = canonical_form(points, faces, settings)
    delta = all_geodesics(triangulated(points, faces))
    weights = squared(spectrum_of(points, faces), np.arange(len(points)), 1) / (delta + np.eye(len(points))) ** 2
    placed, history = smacof(delta, points, weights=weights, max_iterations=12, tolerance=1e-5)
    np.testing.assert_allclose(form.stress, history, rtol=1e-9)
    assert surface_area(form.vertices, faces) == pytest.approx(surface_area(placed, faces), rel=1e-9)
    assert surface_area(placed, faces) > 1.1  # geodesics are longer than chords


@pytest.mark.parametrize("method", BOTH)
def test_what_the_paper_says_does_not_listen_to_the_settings(mesh: Mesh, method):
    plain = canonical_form(*mesh, Settings(method=method, max_iterations=3))
    other = Settings(
        method=method, max_iterations=3, quality="draft", diffusion_time=1.0, preserve_detail=1.0,
        symmetry="ignore",
    )  # fmt: skip
    np.testing.assert_array_equal(canonical_form(*mesh, other).vertices, plain.vertices)
    letter = method_named(method).settings(other)
    assert (letter.quality, letter.diffusion_time) == ("full", 0.1)


@pytest.mark.parametrize("method", BOTH)
def test_the_contract(mesh, method):
    vertices, faces = mesh
    seen = []
    form = canonical_form(
        vertices, faces, Settings(method=method), progress=lambda done, stage: seen.append((done, stage))
    )
    assert np.isfinite(form.vertices).all()
    assert (np.diff(form.stress) <= 1e-12 * form.stress[:-1]).all()
    done = [fraction for fraction, _ in seen]
    assert done == sorted(done)
    assert done[-1] == 1
    assert list(dict.fromkeys(stage for _, stage in seen)) == list(form.timings)
    with pytest.raises(TooLargeError, match="All pairs of points inside the"):
        canonical_form(vertices, faces, Settings(method=method, memory_limit=1e-4))


@pytest.mark.parametrize("stop_at", [1, 20, 60, 100])
def test_cancel_stops_the_run(mesh: Mesh, stop_at):
    asked = iter(range(10**9))
    with pytest.raises(CancelledError):
        canonical_form(*mesh, Settings(method="as_published"), cancelled=lambda: next(asked) >= stop_at)


def test_closed_patches_hold_together_where_open_ones_come_apart(mesh):
    vertices, faces = mesh
    apart = {}
    for method in BOTH:
        form = canonical_form(vertices, faces, Settings(method=method))
        ends = np.concatenate([faces[:, :2], faces[:, 1:]])
        between = ends[form.patches[ends[:, 0]] != form.patches[ends[:, 1]]]
        lengths = [
            np.linalg.norm(each[between[:, 0]] - each[between[:, 1]], axis=1) for each in (form.vertices, vertices)
        ]
        apart[method] = np.median(lengths[0] / lengths[1])
    assert apart["as_published"] > 2 * apart["as_published_closed"]
