"""Quaternions as tuples and kinematics of lists, against those of arrays."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.live.drive import turns
from avatarsim.live.drive.tree import Tree, posture_of
from avatarsim.live.stages import NAMES, stage
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from tests.live.drive.stages_driven import random_sample

number = st.floats(-3.0, 3.0)
vectors = st.tuples(number, number, number)
rotations = vectors.map(turns.exp)


@given(rotations, rotations, vectors)
def test_products_and_turned_vectors_are_those_of_arrays(
    a: tuple[float, float, float, float], b: tuple[float, float, float, float], v: tuple[float, float, float]
) -> None:
    assert np.allclose(turns.multiply(a, b), rotation.multiply(a, b), atol=1e-14)
    assert np.allclose(turns.rotate(a, v), rotation.rotate(a, v), atol=1e-13)


@given(vectors)
def test_exp_and_log_are_those_of_arrays(v: tuple[float, float, float]) -> None:
    assert np.allclose(turns.exp(v), rotation.from_rotation_vector(v), atol=1e-14)
    assert np.allclose(turns.log(turns.exp(v)), rotation.to_rotation_vector(rotation.from_rotation_vector(v)), atol=1e-12)


@given(rotations, rotations)
def test_the_way_from_one_turn_to_another_leads_there(
    a: tuple[float, float, float, float], b: tuple[float, float, float, float]
) -> None:
    reached = turns.turned_by(turns.way(a, b), a)
    assert turns.norm(turns.way(reached, b)) < 1e-12


@given(st.sampled_from(NAMES), st.integers(0, 1000))
def test_poses_are_those_of_the_tracker_module(name: str, seed: int) -> None:
    scene = stage(name).scene
    sample, tree = random_sample(scene, seed), Tree(scene.avatars)
    positions, orientations = link_poses(scene.avatars, sample)
    for k, (place, turned) in enumerate(tree.poses(posture_of(sample))):
        assert place == pytest.approx(positions[k], abs=1e-12)
        assert abs(rotation.multiply(rotation.conjugate(turned), orientations[k])[0]) == pytest.approx(1.0, abs=1e-12)


def test_a_posture_becomes_the_sample_it_was_made_of() -> None:
    scene = stage("hand").scene
    sample = random_sample(scene, 3)
    again = posture_of(sample).sample(2.0)
    assert again.time == 2.0
    for name in ("positions", "rotations", "angles"):
        assert np.allclose(getattr(again, name), getattr(sample, name), atol=1e-15)


def test_chains_and_subtrees_hold_what_is_above_and_below() -> None:
    tree = Tree(stage("hand").scene.avatars)
    names = [node.name for node in tree.nodes]
    assert [names[k] for k in tree.chain(names.index("index3"))] == ["palm", "index1", "index2", "index3"]
    assert [names[k] for k in tree.subtree(names.index("index1"))] == ["index1", "index2", "index3"]
    assert tree.moving([0, 1]) == [1]
