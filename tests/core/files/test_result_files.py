"""Results survive a file, to the bit, and a file from elsewhere does no harm."""

import json
import pickle
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

from addon import core
from addon.core import InvalidFileError, load, mannequin, save
from addon.core.rigging.reference_rig import mannequin_rig
from addon.core.surface.working_surface import working_surface
from tests.meshes import shapes


def coarse():
    found = working_surface(*mannequin(), 1500)
    return np.asarray(found.points), np.asarray(found.faces)


@pytest.fixture(scope="module")
def results():
    figure, body = shapes.figure(14), mannequin()
    posed = shapes.figure(15)
    rig = mannequin_rig(*body)
    quick: dict[str, Any] = {"landmark_count": 60, "quality": "draft"}
    return {
        "form": core.canonical_form(*figure, **quick),
        "patches": core.feature_patches(*figure, **quick),
        "match": core.match(*figure, *posed, **quick),
        "pose": core.pose_like(*figure, *posed, **quick),
        "stance": core.stance_by_bones(*body, rig.skeleton, rig.weights),
        "rig": core.rig(*body, **quick),
    }


def same(one, other):
    """Compare everything that two results hold."""
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)
    elif is_dataclass(one):
        for each in fields(one):
            same(getattr(one, each.name), getattr(other, each.name))
    elif isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            same(one[key], other[key])
    elif isinstance(one, list | tuple):
        assert len(one) == len(other)
        for each, there in zip(one, other, strict=True):
            same(each, there)
    else:
        assert one == other or (one != one and other != other)
        assert getattr(one, "kind", None) == getattr(other, "kind", None)


@pytest.mark.parametrize("kind", ["form", "patches", "match", "pose", "stance", "rig"])
def test_what_is_loaded_is_what_was_saved(results, kind, tmp_path):
    path = save(tmp_path / kind, results[kind])
    assert path == tmp_path / f"{kind}.npz"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    same(load(path), results[kind])


def test_a_form_from_a_file_is_a_reference(results, tmp_path):
    figure = shapes.figure(14)
    reference = load(save(tmp_path / "form.npz", results["form"]))
    again = core.canonical_form(*figure, quality="draft", landmark_count=60, reference=reference)
    beside = core.canonical_form(*figure, quality="draft", landmark_count=60, reference=results["form"])
    np.testing.assert_array_equal(again.vertices, beside.vertices)


def test_arrays_can_be_read_without_this_package(results, tmp_path):
    with np.load(save(tmp_path / "form", results["form"])) as file:
        np.testing.assert_array_equal(file["vertices"], results["form"].vertices)
        assert json.loads(str(file["canonical_form"]))["format"] == 1


@pytest.mark.parametrize("thing", [3, {"vertices": np.zeros(3)}, np.zeros(3), None])
def test_other_things_are_refused(thing, tmp_path):
    with pytest.raises(InvalidFileError, match="Only results can be saved"):
        save(tmp_path / "thing.npz", thing)
    assert not list(tmp_path.iterdir())


def test_files_of_others_are_refused(results, tmp_path):
    path = tmp_path / "other.npz"
    for content in (b"", b"PK\x05\x06", b"not a file", pickle.dumps({"a": 1})):
        path.write_bytes(content)
        with pytest.raises(InvalidFileError, match="does not hold"):
            load(path)
    np.savez(path, vertices=np.zeros(3))
    with pytest.raises(InvalidFileError, match="does not hold"):
        load(path)
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "nothing.npz")


@pytest.mark.parametrize(
    "stored",
    [
        {"format": 1, "result": {"class": "os.system", "values": {}}},
        {"format": 1, "result": {"class": "Skeleton", "values": {}}},
        {"format": 1, "result": {"array": "vertices"}},
        {"format": 1, "result": {"class": "CanonicalForm", "values": {"vertices": {"array": "missing"}}}},
        {"format": 1, "result": 3},
        {"format": 1},
        [],
    ],
)
def test_a_strangers_file_makes_nothing_but_results(stored, tmp_path):
    path = tmp_path / "stranger.npz"
    np.savez(path, canonical_form=np.array(json.dumps(stored)), vertices=np.zeros((3, 3)))
    with pytest.raises(InvalidFileError):
        load(path)


def test_pickled_arrays_are_not_read(tmp_path):
    path = tmp_path / "pickled.npz"
    stored = {"format": 1, "result": {"array": "vertices"}}
    np.savez(path, canonical_form=np.array(json.dumps(stored)), vertices=np.array([print], dtype=object))
    with pytest.raises(InvalidFileError):
        load(path)


def test_a_later_format_says_so(results, tmp_path):
    path = save(tmp_path / "form.npz", results["form"])
    with np.load(path) as file:
        entries = {name: file[name] for name in file.files}
    entries["canonical_form"] = np.array(json.dumps({"format": 99, "result": None}))
    np.savez(path, **entries)
    with pytest.raises(InvalidFileError, match="later version"):
        load(path)
