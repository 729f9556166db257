"""Gaps against the judge, and their rows against differences, between a link and a body and between two links."""

import numpy as np
import pytest

from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from reference.nearest_free.closeness import rates_of_log
from reference.nearest_free.gaps import Gaps
from reference.nearest_free.tree import Tree, posture_of, turn_by
from tests.reference.nearest_free.arm import fist, mixed, planar_arm, posed, wall_scene

SCENE = wall_scene(planar_arm(), fist(), mixed())
TREE = Tree(SCENE)
BODY = np.array([SCENE.bodies[0].position]), np.array([SCENE.bodies[0].orientation])


def near_postures(count):
    """Postures in which something is near something."""
    random, found = np.random.default_rng(0), []
    gaps = Gaps(SCENE, TREE, *BODY)
    while len(found) < count:
        posture = TREE.clipped(posture_of(posed(SCENE, random, 0.25)))
        if len(gaps.rows(TREE.placed(posture))[0]) > 2:
            found.append(posture)
    return found


def test_gaps_are_the_judges():
    judge, gaps = Judge(SCENE), Gaps(SCENE, TREE, *BODY)
    for posture in near_postures(20):
        placed = TREE.placed(posture)
        positions, turns = np.vstack([BODY[0], placed.positions]), np.vstack([BODY[1], rotation.from_matrix(placed.turns)])
        here = judge.distances(positions, turns)[2]
        assert np.sort(gaps.values(placed)) == pytest.approx(np.sort(here), abs=1e-8)


def test_rows_are_differences():
    gaps, both = Gaps(SCENE, TREE, *BODY), set()
    for posture in near_postures(20):
        placed = TREE.placed(posture)
        here, rows = gaps.rows(placed)
        pairs = [pair for pair in gaps.near(placed, 0.1) if gaps.measured(*pair) <= 0.1]
        assert len(pairs) == len(here)
        assert all(SCENE.pair_filter[gaps.pieces.owner[a], gaps.pieces.owner[b]] for a, b in pairs)
        way = np.random.default_rng(1).normal(size=TREE.n)
        ends = []
        for h in (-1e-6, 1e-6):
            gaps.near(TREE.placed(TREE.moved(posture, h * way)), 0.2)
            ends.append(np.array([gaps.measured(*pair) for pair in pairs]))
        assert rows @ way == pytest.approx((ends[1] - ends[0]) / 2e-6, abs=2e-3)
        both |= {min(gaps.pieces.owner[list(pair)]) == 0 for pair in pairs}
    assert both == {True, False}


@pytest.mark.parametrize("angle", [0.0, 0.3, 2.5])
def test_rates_of_a_rotation_vector_are_differences(angle):
    random = np.random.default_rng(3)
    vector = angle * rotation.rotate(rotation.normalised(random.normal(size=4)), np.array([1.0, 0.0, 0.0]))
    spin = random.normal(size=3)
    ends = [rotation.to_rotation_vector(rotation.from_matrix(turn_by(vector) @ turn_by(h * spin))) for h in (-1e-5, 1e-5)]
    assert rates_of_log(vector) @ spin == pytest.approx((ends[1] - ends[0]) / 2e-5, abs=1e-8)
