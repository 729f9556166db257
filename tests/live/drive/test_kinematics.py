"""Kinematics of postures against that of the tracker module."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.live.drive.tree import Tree, posture_of
from avatarsim.live.stages import NAMES, stage
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from tests.live.drive.stages_driven import random_sample


@given(st.sampled_from(NAMES), st.integers(0, 1000))
def test_poses_are_those_of_the_tracker_module(name: str, seed: int) -> None:
    scene = stage(name).scene
    sample, tree = random_sample(scene, seed), Tree(scene.avatars)
    positions, orientations = link_poses(scene.avatars, sample)
    places, turns = tree.poses(posture_of(sample))
    assert places == pytest.approx(positions, abs=1e-12)
    assert np.abs(rotation.multiply(rotation.conjugate(turns), orientations)[:, 0]) == pytest.approx(1.0, abs=1e-12)


def test_chains_and_subtrees_hold_what_is_above_and_below() -> None:
    tree = Tree(stage("hand").scene.avatars)
    names = [node.name for node in tree.nodes]
    assert [names[k] for k in tree.chain(names.index("index3"))] == ["palm", "index1", "index2", "index3"]
    assert [names[k] for k in tree.subtree(names.index("index1"))] == ["index1", "index2", "index3"]
    assert tree.moving([0, 1]) == [1]
