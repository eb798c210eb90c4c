"""The contract of the core on meshes that nobody would draw: made up, broken, and whatever else hypothesis thinks of.

``CANONICAL_FORM_EXAMPLES=20000 python -m pytest tests/core/test_contract.py`` is the long run, with other examples
every time; the ordinary one is short and always the same.
"""

import os
from contextlib import suppress
from functools import cache

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings

from addon.core import InvalidMeshError, Settings, canonical_form
from addon.core.assembly.pieces import connected_pieces
from addon.core.assembly.strays import drawn_in, stray_vertices
from addon.core.distance_fields import heat_geodesics
from addon.core.measures.alignment import rigid_fit
from addon.core.mesh.geometry import surface_area
from addon.core.surface.triangulation import corner_lengths
from tests.meshes import shapes
from tests.meshes.families import families, klein_bottle, moebius_band, torus
from tests.meshes.shapes import Mesh

MANY = int(os.environ.get("CANONICAL_FORM_EXAMPLES", "0"))
QUICK = Settings(quality="draft", max_iterations=30, landmark_count=20)


def examples(share):
    """Split the examples over the tests."""
    return settings(
        max_examples=max(int(share * (MANY or 80)), 1), deadline=None, derandomize=not MANY, database=None,
        suppress_health_check=list(HealthCheck), phases=[Phase.explicit, Phase.generate, Phase.shrink],
        print_blob=True,
    )  # fmt: skip


@cache
def sound():
    """Sound surfaces to start from."""
    rng = np.random.default_rng(1)
    return [
        shapes.sphere(1), shapes.sphere(2), shapes.grid(6, 5), shapes.cylinder(7, 6), shapes.joint(70, 12, 7),
        torus(12, 7), moebius_band(14, 4), klein_bottle(14, 9),
        (families()["tetrahedron"].vertices, families()["tetrahedron"].faces),
        (np.eye(3), np.array([[0, 1, 2]])), blob(rng), blob(rng),
    ]  # fmt: skip


def blob(rng):
    """A body with limbs here and there."""
    axis = np.linspace(-1, 1, 8)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    field = sum(np.exp(-12 * ((points - centre) ** 2).sum(axis=1)) for centre in rng.uniform(-0.6, 0.6, (6, 3)))
    vertices, faces = shapes.level_set(points, field - 0.35, [8, 8, 8])
    return vertices, faces


@st.composite
def meshes(draw, broken=True):
    """Draw a mesh: a sound one, or several, or random faces; then damage it."""
    kind = draw(st.integers(0, 14))
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    if kind < 12:
        vertices, faces = (each.copy() for each in sound()[kind])
    elif kind == 12 and broken:
        count = draw(st.integers(3, 14))
        vertices = rng.normal(size=(count, 3))
        faces = rng.integers(0, count, (draw(st.integers(1, 24)), 3))
    else:
        one, two = sound()[draw(st.integers(0, 11))], sound()[draw(st.integers(0, 11))]
        vertices = np.vstack([one[0], 0.7 * two[0] + 3])
        faces = np.vstack([one[1], two[1] + len(one[0])])
    vertices = vertices + 0.02 * rng.normal(size=vertices.shape)  # nothing is flat or symmetric: both have two forms
    if broken:
        for damage in draw(st.lists(st.sampled_from(DAMAGES), max_size=4)):
            if len(vertices):  # something is left to damage
                vertices, faces = damage(vertices, faces, rng)
    return vertices, faces


def some(rng, count):
    """Choose a few of so many."""
    return rng.choice(count, int(np.ceil(count * rng.uniform(0, 0.4))), replace=False)


def fewer_faces(vertices, faces, rng):
    """Lose faces."""
    return vertices, np.delete(faces, some(rng, len(faces)), axis=0)


def copied_faces(vertices, faces, rng):
    """Have faces twice, in any order of corners."""
    return vertices, np.vstack([faces, rng.permuted(faces[some(rng, len(faces))], axis=1)])


def turned_faces(vertices, faces, rng):
    """Turn faces over."""
    faces = faces.copy()
    which = some(rng, len(faces))
    faces[which] = faces[which][:, ::-1]
    return vertices, faces


def glued_vertices(vertices, faces, rng):
    """Take vertices for others."""
    onto = np.arange(len(vertices))
    which = some(rng, len(vertices))[:3]
    onto[which] = rng.integers(0, len(vertices), len(which))
    return vertices, onto[faces] if len(faces) else faces


def same_places(vertices, faces, rng):
    """Put vertices where others are."""
    vertices = vertices.copy()
    which = some(rng, len(vertices))
    vertices[which] = vertices[rng.integers(0, len(vertices), len(which))]
    return vertices, faces


def near_places(vertices, faces, rng):
    """Put vertices very near to others."""
    moved, _ = same_places(vertices, faces, rng)
    return moved + 10.0 ** rng.uniform(-14, -3) * rng.normal(size=moved.shape), faces


def spikes(vertices, faces, rng):
    """Pull vertices far out."""
    vertices = vertices.copy()
    which = some(rng, len(vertices))[:3]
    vertices[which] *= 10.0 ** rng.uniform(0, 6)
    return vertices, faces


def squeezed(vertices, faces, rng):
    """Make it flat, or nearly so."""
    return vertices * [1.0, 1.0, rng.choice([0.0, 1e-12, 1e-6, 1e-2])], faces


def stretched(vertices, faces, rng):
    """Make it long."""
    return vertices * [10.0 ** rng.uniform(0, 5), 1.0, 1.0], faces


def loose_vertices(vertices, faces, rng):
    """Add vertices of no face."""
    return np.vstack([vertices, rng.normal(size=(rng.integers(1, 5), 3))]), faces


def torn_apart(vertices, faces, rng):
    """Give every face vertices of its own."""
    return vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3)


def extra_faces(vertices, faces, rng):
    """Add faces between any vertices."""
    return vertices, np.vstack([faces, rng.integers(0, len(vertices), (rng.integers(1, 4), 3))])


def other_size(vertices, faces, rng):
    """Make it tiny or huge."""
    return vertices * 10.0 ** rng.uniform(-30, 30), faces


def far_away(vertices, faces, rng):
    """Move it away from the origin."""
    return vertices + 10.0 ** rng.uniform(0, 6) * np.abs(vertices).max(initial=0.0), faces


def single_precision(vertices, faces, rng):
    """Round positions."""
    with np.errstate(over="ignore"):  # what is too large for it becomes infinite, and is to be refused
        return vertices.astype(np.float32).astype(float), faces


DAMAGES = [
    fewer_faces, copied_faces, turned_faces, glued_vertices, same_places, near_places, spikes, squeezed, stretched,
    loose_vertices, torn_apart, extra_faces, other_size, far_away, single_precision,
]  # fmt: skip


@st.composite
def meshes_of_pieces(draw):
    """Draw a mesh and put smaller and larger copies, turned and squeezed, on, in and beside it; then damage it."""
    vertices, faces = draw(meshes())
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    points, corners, count = [vertices], [faces], len(vertices)
    with np.errstate(all="ignore"):  # what is infinite becomes no number, and is to be refused
        size = float(np.ptp(vertices, axis=0).max(initial=0.0)) if len(vertices) else 1.0
        for _ in range(draw(st.integers(1, 8))):
            own, its = sound()[rng.integers(0, 12)]
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] * 10.0 ** rng.uniform(-1.5, 0.3, (3, 1))
            place = vertices[rng.integers(0, len(vertices))] if len(vertices) else np.zeros(3)
            points.append((0.3 * own @ turn + 0.1 * rng.normal(size=3)) * (size or 1.0) + place)
            corners.append(its + count)
            count += len(own)
        mesh = np.vstack(points), np.vstack([each.reshape(-1, 3) for each in corners])
        for index in draw(st.lists(st.integers(0, len(DAMAGES) - 1), max_size=2)):
            mesh = DAMAGES[index](*mesh, rng)
    return mesh


def form_or_reason(mesh: Mesh):
    """Give the form, or None where the mesh is refused in words."""
    with suppress(InvalidMeshError):  # the only error that is allowed
        return canonical_form(*mesh, QUICK)
    return None


def made(seed):
    """A mesh as `meshes` draws them, from one number: those that once failed are kept by it."""
    rng = np.random.default_rng(seed)
    kind = rng.integers(0, 15)
    if kind < 12:
        vertices, faces = (each.copy() for each in sound()[kind])
    elif kind == 12:
        count = rng.integers(3, 15)
        vertices = rng.normal(size=(count, 3))
        faces = rng.integers(0, count, (rng.integers(1, 25), 3))
    else:
        one, two = sound()[rng.integers(0, 12)], sound()[rng.integers(0, 12)]
        vertices, faces = np.vstack([one[0], 0.7 * two[0] + 3]), np.vstack([one[1], two[1] + len(one[0])])
    vertices = vertices + 0.02 * rng.normal(size=vertices.shape)
    for index in rng.integers(0, len(DAMAGES), rng.integers(0, 5)):
        vertices, faces = DAMAGES[index](vertices, faces, rng)
    return vertices, faces


def damaged(kind, seed, *damages):
    """A sound mesh, noise on it, and these damages, as `meshes` draws them."""
    rng = np.random.default_rng(seed)
    vertices, faces = (each.copy() for each in sound()[kind])
    vertices = vertices + 0.02 * rng.normal(size=vertices.shape)
    for damage in damages:
        vertices, faces = damage(vertices, faces, rng)
    return vertices, faces


def spiked(size):
    """A ball with one vertex pulled far out: triangles of very different sizes."""
    vertices, faces = shapes.sphere(1)
    vertices = vertices + 0.02 * np.random.default_rng(0).normal(size=vertices.shape)
    vertices[5] *= size
    return vertices, faces


ONCE = {
    "needles 10⁵ times as long as wide": made(5168),
    "the same with faces twice": made(317),
    "far away": made(333),
    "spikes far away": made(10820),
    "spikes, far away, with spikes": damaged(1, 0, spikes, far_away, far_away, spikes),
    "edges of no length beside spikes": damaged(0, 0, spikes, same_places, stretched),
    "a spike of 10³": spiked(1e3),
    "a spike of 10⁶": spiked(1e6),
}


@pytest.mark.parametrize("name", ONCE)
def test_what_once_failed(name):
    test_any_mesh_has_a_form_or_a_reason.hypothesis.inner_test(ONCE[name])


@examples(0.6)
@given(meshes())
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_any_mesh_has_a_form_or_a_reason(mesh):
    vertices, _ = mesh
    form = form_or_reason(mesh)
    if form is None:
        return
    assert form.vertices.shape == vertices.shape
    assert np.isfinite(form.vertices).all()
    assert np.isfinite(form.adf).all()
    count = len(form.feature_points)
    np.testing.assert_array_equal(form.patches[form.feature_points], np.arange(count))
    assert form.patches.min() >= -1
    assert form.patches.max() == count - 1
    size = float(np.ptp(vertices[form.faces.ravel()], axis=0).max())
    middle = vertices[form.faces[0, 0]]
    strays = stray_vertices(vertices, form.faces)
    surfaces = [drawn_in(each, form.faces, strays) for each in (vertices, form.vertices)]
    before, after = (surface_area((each - middle) / size, form.faces) for each in surfaces)
    rounding = 1e-15 * np.abs([vertices, form.vertices]).max() / size  # of positions, which shows in long thin faces
    around = corner_lengths((vertices - middle) / size, form.faces).sum()
    rel = 0.1 if len(strays) else 1e-6  # the area is that of the surface without them
    assert after == pytest.approx(before, rel=rel, abs=4 * rounding * around)


@examples(0.1)
@given(meshes_of_pieces())
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_any_pieces_have_a_form_or_a_reason(mesh):
    test_any_mesh_has_a_form_or_a_reason.hypothesis.inner_test(mesh)


@examples(0.2)
@given(meshes(broken=False), st.integers(0, 2**32 - 1))
def test_motion_size_and_numbering_do_not_change_the_form(mesh, seed):
    vertices, faces = mesh
    rng = np.random.default_rng(seed)
    form = form_or_reason(mesh)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    size, shift = 10.0 ** rng.uniform(-20, 20), rng.normal(size=3)
    order = rng.permutation(len(vertices))
    number = np.argsort(order)
    other = canonical_form(size * (vertices @ turn + shift)[order], rng.permutation(number[faces]), QUICK)
    back = other.vertices[number] / size
    rotation, move = rigid_fit(back, form.vertices)
    apart = np.linalg.norm(back @ rotation + move - form.vertices, axis=1)
    assert apart.max() < 1e-3 * np.ptp(vertices, axis=0).max()


@examples(0.1)
@given(meshes())
def test_the_same_mesh_gives_the_same_bits(mesh):
    one, two = form_or_reason(mesh), form_or_reason(mesh)
    if one is not None:
        np.testing.assert_array_equal(one.vertices, two.vertices)
        np.testing.assert_array_equal(one.patches, two.patches)


@examples(0.1)
@given(meshes(broken=False), st.integers(0, 2**32 - 1))
def test_distances_are_distances(mesh, seed):
    vertices, faces = mesh
    piece = connected_pieces(vertices, faces).pieces[0]
    some = np.unique(np.random.default_rng(seed).integers(0, len(piece.vertices), 6))
    between = heat_geodesics(piece.points, piece.faces, some)[some]
    largest = between.max()
    assert (between >= -0.02 * largest).all()
    assert (np.diag(between) == 0).all()
    assert np.abs(between - between.T).max() <= 0.12 * largest
    around = (between[:, :, None] + between[None]).min(axis=1)
    assert (between <= around + 0.12 * largest).all()
    straight = np.linalg.norm(piece.points[some][:, None] - piece.points[some], axis=2)
    assert (between >= straight - 0.12 * largest).all()
