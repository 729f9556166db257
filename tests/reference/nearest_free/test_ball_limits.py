"""Margins of ball joints against the measures of excess, which share no code with them."""

import numpy as np
import pytest

from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from reference.nearest_free.ball_limits import BallLimits
from reference.nearest_free.tree import Tree, posture_of, turn_by
from scenarios.measure.posture.limits import joint_limit_excess, reach_cone_excess
from tests.reference.nearest_free.arm import mixed, posed, wall_scene

SCENE = wall_scene(mixed())
TREE = Tree(SCENE)
BALLS = {k: BallLimits(SCENE.links[k].joint, TREE.zero[k]) for k in (2, 3)}


def test_a_posture_is_within_its_margins_where_the_measures_find_no_excess():
    random, inside, outside = np.random.default_rng(1), 0, 0
    for _ in range(300):
        sample = posed(SCENE, random, 0.5)
        posture = TREE.clipped(posture_of(sample))
        placed = TREE.placed(posture)
        turns = rotation.from_matrix(placed.turns)[None]
        excess = max(joint_limit_excess(SCENE, turns, posture.angles[None])[0], reach_cone_excess(SCENE, turns)[0])
        least = min(ball.margins(placed.relative[k]).min() for k, ball in BALLS.items())
        assert (least >= -1e-9) == (excess <= 1e-9)
        assert excess == pytest.approx(max(-least, 0.0), abs=1e-9)
        inside, outside = inside + (least > 0.0), outside + (least < 0.0)
    assert min(inside, outside) > 20


def test_slopes_are_differences():
    random = np.random.default_rng(2)
    for link, ball in BALLS.items():
        relative = TREE.placed(posture_of(posed(SCENE, random, 0.2))).relative[link]
        here, slopes = ball.rows(relative)
        step = 1e-4 * random.normal(size=3)
        assert ball.margins(relative @ turn_by(step)) == pytest.approx(here + slopes @ step, abs=1e-6)


def test_poses_of_the_plain_twin_have_the_same_margins():
    sample = posed(SCENE, np.random.default_rng(3), 0.3)
    _, orientations = link_poses(SCENE.avatars, sample)
    told = TREE.from_poses(np.zeros((4, 3)), orientations, sample.angles)
    for link, ball in BALLS.items():
        a, b = (ball.margins(TREE.placed(p).relative[link]) for p in (told, posture_of(sample)))
        assert a == pytest.approx(b, abs=1e-9)
