import numpy as np
import pytest
from scipy.optimize import isotonic_regression
from scipy.spatial.distance import pdist, squareform
from sklearn.manifold import ClassicalMDS
from sklearn.manifold import smacof as sklearn_smacof

from addon.core import CancelledError, InvalidSettingsError, Settings, TooLargeError, canonical_form
from addon.core.distance_fields import heat_geodesics
from addon.core.embedding.classical_scaling import leading_scaling
from addon.core.embedding.smacof import smacof
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import compactness_error, edge_stretch
from addon.core.mesh.geometry import surface_area
from addon.core.method_api.catalogue import methods
from addon.core.method_api.costs import memory_estimate
from addon.core.methods.fast import fast_map
from addon.core.methods.non_metric import non_metric_scaling
from addon.core.methods.one_form import with_one_form_kept
from addon.core.methods.skeleton import curve_skeleton
from tests.meshes import shapes
from tests.meshes.shapes import Mesh

RIVALS = ("classical", "least_squares", "non_metric", "fast", "euclidean_random", "euclidean_normalised", "one_form",
          "skeleton")  # fmt: skip


@pytest.fixture(scope="module")
def distances():
    """Geodesics between 500 points of a small figure: not Euclidean."""
    vertices, faces = shapes.figure(13)
    some = np.arange(500)
    table = heat_geodesics(vertices, faces, some)[some]
    table = (table + table.T) / 2
    np.fill_diagonal(table, 0.0)
    return np.maximum(table, 0.0)


@pytest.fixture(scope="module")
def forms(figure: Mesh):
    return {method: canonical_form(*figure, Settings(method=method)) for method in RIVALS}


def test_every_rival_has_a_name_in_the_settings():
    assert list(methods()) == ["straight", *RIVALS, "as_published", "as_published_closed", "local_features"]
    assert [Settings(method=name).method for name in methods()] == list(methods())
    with pytest.raises(
        InvalidSettingsError,
        match=r"method must be one of straight, classical, .*, as_published_closed, local_features; got 'tsne'",
    ) as refused:
        Settings(method="tsne")
    assert refused.value.kind == "unknown_method"


def test_classical_scaling_is_that_of_scikit_learn(distances):
    theirs = ClassicalMDS(n_components=3, metric="precomputed").fit_transform(distances)
    for ours in (leading_scaling(distances), leading_scaling(distances[:300, :300])):
        wanted = (
            theirs
            if len(ours) == 500
            else ClassicalMDS(n_components=3, metric="precomputed").fit_transform(distances[:300, :300])
        )
        ours = ours * np.sign((ours * wanted).sum(axis=0))
        np.testing.assert_allclose(ours, wanted, atol=1e-8 * np.abs(wanted).max())


def test_least_squares_reaches_the_stress_of_scikit_learn(distances):
    start = leading_scaling(distances)
    _, history = smacof(distances, start, max_iterations=3000, tolerance=1e-9)
    _, theirs = sklearn_smacof(distances, init=start, n_init=1, max_iter=3000, eps=1e-9, normalized_stress=False)
    assert history[-1] == pytest.approx(theirs, rel=0.01)
    assert history[-1] <= theirs * (1 + 1e-6)
    assert (np.diff(history) <= 1e-12 * history[:-1]).all()


def pooled(values):
    """Isotonic regression by the min-max formula: brute force over all intervals."""
    count = len(values)
    mean = np.array([[values[i : j + 1].mean() if j >= i else np.nan for j in range(count)] for i in range(count)])
    return np.array([max(min(mean[i, j] for j in range(k, count)) for i in range(k + 1)) for k in range(count)])


def test_isotonic_regression_is_that_by_brute_force():
    rng = np.random.default_rng(0)
    for _ in range(20):
        values = rng.normal(size=12)
        np.testing.assert_allclose(isotonic_regression(values).x, pooled(values), atol=1e-12)


def test_non_metric_disparities_rise_with_the_distances(distances):
    start = leading_scaling(distances[:12, :12])
    points, history, wanted = non_metric_scaling(distances[:12, :12], start, max_iterations=50, tolerance=0.0)
    given, straight = squareform(distances[:12, :12]), pdist(points)
    order = np.argsort(given, kind="stable")
    best = pooled(straight[order])
    best *= np.sqrt((given**2).sum() / (best**2).sum())
    np.testing.assert_allclose(wanted[order], best, atol=1e-10)
    assert history[-1] == pytest.approx(((best - straight[order]) ** 2).sum(), rel=1e-8)
    assert (np.diff(history) <= 1e-12 * history[:-1]).all()


def test_non_metric_scaling_knows_the_order_only():
    points = np.random.default_rng(1).normal(size=(60, 3))
    straight = squareform(pdist(points))
    found, history, _ = non_metric_scaling(
        straight**3, leading_scaling(straight**3), max_iterations=3000, tolerance=0.0
    )
    assert history[-1] < 2e-3 * history[0]
    assert np.corrcoef(pdist(found), pdist(points))[0, 1] > 0.995


def naive_fast_map(table, first, dimensions):
    """FastMap on a whole matrix, as its authors write it down."""
    count = len(table)
    squared, places = table**2, np.zeros((count, dimensions))
    for axis in range(dimensions):
        near = far = first
        for _ in range(5):
            near, far = far, max(range(count), key=squared[far].__getitem__)
        between = squared[near, far]
        for i in range(count):
            places[i, axis] = (squared[near, i] + between - squared[far, i]) / (2 * between**0.5)
        for i in range(count):
            for j in range(count):
                squared[i, j] = max(squared[i, j] - (places[i, axis] - places[j, axis]) ** 2, 0.0)
    return places


def test_fast_map_is_that_by_brute_force(distances):
    table = distances[:40, :40]
    places, pivots = fast_map(lambda point: table[point], 3)
    assert len(pivots) == 6
    np.testing.assert_allclose(places, naive_fast_map(table, 3, 3), atol=1e-9)


def test_fast_map_of_a_box_is_exact():
    corners = np.array([[x, y, z] for x in (0, 3) for y in (0, 2) for z in (0, 1)], dtype=float)
    table = squareform(pdist(corners))
    places, _ = fast_map(lambda point: table[point], 0)
    np.testing.assert_allclose(squareform(pdist(places)), table, atol=1e-9)


@pytest.mark.parametrize("method", RIVALS)
def test_the_contract(figure, forms, method):
    vertices, faces = figure
    form = forms[method]
    assert form.vertices.shape == vertices.shape
    assert np.isfinite(form.vertices).all()
    assert (np.diff(form.stress) <= 1e-12 * form.stress[:-1]).all()
    assert len(form.feature_points) == 5
    assert form.pair_count > 0
    turn = rigid_fit(form.vertices, vertices)[0]
    assert np.linalg.norm(turn - np.eye(3)) < 0.2  # the fit of the form weighs by area
    np.testing.assert_array_equal(canonical_form(vertices, faces, Settings(method=method)).vertices, form.vertices)


@pytest.mark.parametrize("method", RIVALS)
def test_where_and_how_large_a_mesh_is_does_not_matter(figure, forms, method, rotation):
    vertices, faces = figure
    moved = (
        canonical_form(700 * (vertices @ rotation + [1.0, -3.0, 2.0]), faces, Settings(method=method)).vertices / 700
    )
    turn, shift = rigid_fit(moved, forms[method].vertices)
    apart = np.linalg.norm(moved @ turn + shift - forms[method].vertices, axis=1).max()
    assert apart < 1e-5 * np.linalg.norm(np.ptp(vertices, axis=0))


@pytest.mark.parametrize("method", ["classical", "least_squares", "non_metric", "one_form"])
def test_landmarks_stand_for_all_pairs(method):
    vertices, faces = shapes.figure(13)
    many = canonical_form(vertices, faces, Settings(method=method, quality="full"))
    few = canonical_form(vertices, faces, Settings(method=method, landmark_count=150))
    assert many.pair_count == len(vertices) ** 2
    assert few.pair_count == 150 * len(vertices)
    turn, shift = rigid_fit(few.vertices, many.vertices, mirror=True)
    apart = np.sqrt(((few.vertices @ turn + shift - many.vertices) ** 2).sum(axis=1).mean())
    assert apart < 0.12 * np.sqrt(surface_area(vertices, faces))


@pytest.mark.parametrize("method", RIVALS)
def test_small_meshes_use_all_their_vertices(method):
    vertices, faces = shapes.sphere(1)
    egg = vertices * [1.0, 1.5, 2.5]
    default = canonical_form(egg, faces, Settings(method=method)).vertices
    full = canonical_form(egg, faces, Settings(method=method, quality="full")).vertices
    turn, shift = rigid_fit(default, full, mirror=True)
    assert np.abs(default @ turn + shift - full).max() < 0.25
    assert np.median(np.abs(edge_stretch(egg, default, faces) - 1)) < 0.35
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    tetrahedron = canonical_form(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], Settings(method=method))
    assert np.isfinite(tetrahedron.vertices).all()


def test_detail_is_kept_by_those_that_promise_it(figure, forms):
    vertices, faces = figure
    error = {name: compactness_error(vertices, form.vertices, faces) for name, form in forms.items()}
    stretch = {
        name: np.median(np.abs(edge_stretch(vertices, form.vertices, faces) - 1)) for name, form in forms.items()
    }
    assert error["skeleton"] < 0.5 * error["least_squares"]
    assert stretch["one_form"] < stretch["least_squares"]
    assert stretch["skeleton"] < 0.06


def test_the_skeleton_of_a_tube_is_its_axis_and_comes_out_straight():
    vertices, faces = shapes.bent_tube()
    skeleton = curve_skeleton(vertices, faces, heat_geodesics(vertices, faces, [0])[:, 0].clip(0))
    radius = np.hypot(skeleton.nodes[:, 0], skeleton.nodes[:, 1])
    assert np.abs(radius - 1).max() < 0.05
    assert len(skeleton.bones) == len(skeleton.nodes) - 1  # a tree
    lengths = skeleton.path_lengths()
    assert lengths.max() == pytest.approx(np.pi, rel=0.08)
    form = canonical_form(vertices, faces, Settings(method="skeleton")).vertices
    spread = np.linalg.svd(form - form.mean(axis=0), compute_uv=False)
    assert spread[1] < 0.2 * spread[0]
    assert np.median(np.abs(edge_stretch(vertices, form, faces) - 1)) < 0.08


def test_a_turned_layout_gives_back_the_mesh(figure, rotation):
    vertices, faces = figure
    form = with_one_form_kept(vertices, faces, 2.5 * vertices @ rotation + 4.0)
    np.testing.assert_allclose(form, (vertices - vertices.mean(axis=0)) @ rotation, atol=1e-6)


@pytest.mark.parametrize("method", RIVALS)
def test_rivals_stop_when_asked_and_tell_the_progress(figure: Mesh, method):
    seen = []
    canonical_form(*figure, Settings(method=method), progress=lambda done, _: seen.append(done))
    assert seen == sorted(seen)
    assert seen[-1] == 1
    asked = []

    def cancelled():
        asked.append(1)
        return len(asked) > 60

    with pytest.raises(CancelledError):
        canonical_form(*figure, Settings(method=method), cancelled=cancelled)


def test_all_pairs_of_a_large_mesh_are_refused_before_they_are_computed(figure: Mesh):
    with pytest.raises(TooLargeError, match="All pairs of points need it"):
        canonical_form(*figure, Settings(method="classical", quality="full", memory_limit=0.02))
    assert memory_estimate(13_000, Settings(method="classical", quality="full")) > 6
    assert memory_estimate(13_000, Settings(method="classical")) < 0.5
