"""A skeleton carried to another body over the mannequin, and bodies that are not of one kind."""

import numpy as np
import pytest

from addon.core import InvalidMeshError, Settings, mannequin, rig
from addon.core.rigging import bridge
from addon.core.rigging.bridge import Alike, Bridge, over_mannequin
from addon.core.rigging.proportions import BUILDS, reshaped, scales_of
from addon.core.rigging.reference_rig import ReferenceRig, mannequin_rig
from addon.core.rigging.references import unfolded_reference
from addon.core.rigging.skeleton import skinned
from addon.core.rigging.standing import strained
from addon.core.run.monitor import Monitor
from tests.core.rigging.test_stance_gate import fitted
from tests.meshes import animals
from tests.meshes.bent_rigs import posed

BENDS = {"upper_arm.L": (0, 50, 0), "forearm.L": (0, 0, -70), "thigh.L": (-50, 0, 0), "shin.L": (60, 0, 0)}


@pytest.fixture(scope="module")
def adult():
    return unfolded_reference(mannequin_rig(*mannequin()), Settings(), Monitor())


def unnamed(one: ReferenceRig) -> ReferenceRig:
    """The same rig with bones whose names tell nothing."""
    names = [f"Bone{number}" for number in range(len(one.skeleton.names))]
    return one._replace(skeleton=one.skeleton._replace(names=names))


def test_bones_of_any_name_find_their_way_by_what_the_mannequin_knows(adult):
    figure = reshaped(adult.rig, scales_of(adult.rig, BUILDS["figure"]))
    lender = unfolded_reference(unnamed(figure), Settings(), Monitor())
    motions = posed(adult.rig, BENDS)
    walker = adult.rig._replace(vertices=skinned(adult.rig.vertices, adult.rig.weights, motions))
    body = unfolded_reference(walker, Settings(), Monitor()).body
    found = over_mannequin(body, lender, adult, lambda: [], (Monitor(), Monitor()))
    heads = found.candidates[0].fit.bones.heads * body.found.unit + body.found.centre
    off = np.linalg.norm(heads - motions.heads, axis=1) / np.ptp(walker.vertices[:, 2])
    assert found.humans == 2
    assert off.mean() < 0.03
    assert found.alike(found.candidates[0]) is Alike.YES


@pytest.mark.parametrize(
    ("humans", "trust", "alike"), [(2, 0.1, Alike.YES), (1, 0.9, Alike.NO), (0, 0.2, Alike.NO), (0, 0.5, Alike.PERHAPS)]
)
def test_of_a_human_and_a_beast_one_is_no_donor_of_the_other(humans, trust, alike):
    assert Bridge([], humans).alike(fitted(trust=trust)) is alike


def test_a_body_that_a_stance_would_strain_is_no_human(adult, monkeypatch):
    seen = []

    def measured(*given):
        seen.append(strained(*given))
        return 0.1, 0.0

    monkeypatch.setattr(bridge, "strained", measured)
    assert over_mannequin(adult.body, adult, adult, lambda: [], (Monitor(), Monitor())).humans == 0
    assert np.array(seen).shape == (2, 2)
    assert np.all(np.array(seen) < [0.014, 11.3])  # the mannequin's own are of right stances


def test_a_body_gets_no_bones_of_another_kind(adult):
    vertices, faces = animals.giraffe()
    with pytest.raises(InvalidMeshError) as told:
        rig(vertices, faces, unnamed(mannequin_rig(*mannequin())), Settings(quality="draft"))
    assert told.value.kind == "rig_unlike"
