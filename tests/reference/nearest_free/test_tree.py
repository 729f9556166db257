"""Kinematics of the search against the plain twin and against differences."""

import numpy as np
import pytest

from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from reference.nearest_free.tree import Tree, posture_of
from tests.reference.nearest_free.arm import fist, mixed, planar_arm, posed, wall_scene

SCENE = wall_scene(mixed(), planar_arm(), fist())
TREE = Tree(SCENE)


@pytest.mark.parametrize("seed", range(5))
def test_links_are_where_the_tracker_has_them(seed):
    sample = posed(SCENE, np.random.default_rng(seed))
    positions, orientations = link_poses(SCENE.avatars, sample)
    placed = TREE.placed(posture_of(sample))
    assert placed.positions == pytest.approx(positions, abs=1e-12)
    assert placed.turns == pytest.approx(rotation.to_matrix(orientations), abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_a_posture_read_from_poses_is_the_posture(seed):
    sample = posed(SCENE, np.random.default_rng(seed))
    positions, orientations = link_poses(SCENE.avatars, sample)
    placed = TREE.placed(TREE.from_poses(positions, orientations, sample.angles))
    assert placed.positions == pytest.approx(positions, abs=1e-12)
    assert placed.turns == pytest.approx(rotation.to_matrix(orientations), abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_rates_of_a_point_are_differences(seed):
    random = np.random.default_rng(seed)
    posture = TREE.clipped(posture_of(posed(SCENE, random, 0.2)))
    placed = TREE.placed(posture)
    for link in range(len(SCENE.links)):
        local = random.normal(size=3)
        rates = TREE.point_rates(placed, link, placed.positions[link] + placed.turns[link] @ local)
        for j in range(TREE.n):
            ends = []
            for h in (-1e-6, 1e-6):
                there = TREE.placed(TREE.moved(posture, h * np.eye(TREE.n)[j]))
                ends.append(there.positions[link] + there.turns[link] @ local)
            assert rates[:, j] == pytest.approx((ends[1] - ends[0]) / 2e-6, abs=1e-7)


def test_hinges_end_inside_their_limits():
    moved = TREE.moved(posture_of(posed(SCENE, np.random.default_rng(0))), np.full(TREE.n, 9.0))
    assert (moved.angles == TREE.limits[:, 1]).all()
