"""The search against closed forms and against trying all."""

import numpy as np
import pytest

from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from tests.nearest_free.arm import RADIUS, WALL, fist, mixed, planar_arm, posed, wall_scene
from tests.nearest_free.search import Found, Problem, descend, nearest, scattered
from tests.nearest_free.tree import Tree, posture_of


def problem_of(scene, sample, low=-np.inf, high=np.inf, arm=None):
    tree, links = Tree(scene), len(scene.links)
    positions = np.array([body.position for body in scene.bodies]).reshape(-1, 3)
    orientations = np.array([body.orientation for body in scene.bodies]).reshape(-1, 4)
    sides = np.full((links, 3), -np.inf), np.full((links, 3), np.inf)
    sides[0][:, 0], sides[1][:, 0] = low, high
    return Problem(scene, tree, positions, orientations, posture_of(sample), *sides, arm)


def nearest_one(problem, starts) -> Found:
    """Return the nearest free posture; there is one."""
    found = nearest(problem, starts)
    assert found is not None
    return found


@pytest.mark.parametrize("depth", [1e-4, 0.03, 0.12])
def test_a_ball_in_a_wall_comes_out_the_short_way(depth):
    scene = wall_scene(fist())
    at = np.array([[WALL - RADIUS + depth, 0.3, 0.2]])
    sample = TrackerSample(0.0, at, np.array([rotation.IDENTITY]), np.zeros(0))
    found = nearest_one(problem_of(scene, sample), [posture_of(sample)])
    assert found.offset == pytest.approx(depth, abs=2e-6)
    assert found.angle == pytest.approx(0.0, abs=1e-6)
    assert found.posture.roots[0] == pytest.approx([WALL - RADIUS, 0.3, 0.2], abs=3e-6)


def test_a_region_keeps_it_on_this_side_of_the_wall():
    scene = wall_scene(fist())
    # beyond the middle: the short way out is the far side, 0.02 m away
    sample = TrackerSample(0.0, np.array([[WALL + 0.28, 0.0, 0.0]]), np.array([rotation.IDENTITY]), np.zeros(0))
    free, kept = problem_of(scene, sample), problem_of(scene, sample, high=WALL)
    assert nearest_one(free, [posture_of(sample)]).offset == pytest.approx(0.02, abs=2e-6)
    this_side = TrackerSample(0.0, np.zeros((1, 3)), sample.rotations, sample.angles)
    found = nearest_one(kept, [posture_of(sample), posture_of(this_side)])
    assert found.offset == pytest.approx(0.38, abs=2e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_planar_arm_ends_where_trying_all_postures_ends(seed):
    random = np.random.default_rng(seed)
    scene, judge = wall_scene(planar_arm()), Judge(wall_scene(planar_arm()))
    user = TrackerSample(0.0, np.zeros((2, 3)), np.tile(rotation.IDENTITY, (2, 1)), random.uniform(-0.25, 0.25, 2))
    problem = problem_of(scene, user)
    tree, best, at = problem.tree, np.inf, np.zeros(2)
    for width in (1.5, 0.15, 0.015, 0.0015):
        for angles in np.stack(np.meshgrid(*(m + np.linspace(-width, width, 31) for m in at)), axis=-1).reshape(-1, 2):
            posture = tree.clipped(posture_of(TrackerSample(0.0, user.positions, user.rotations, angles)))
            placed = tree.placed(posture)
            score = problem.closeness.score(placed)
            if score < best:
                positions = np.vstack([scene.bodies[0].position, placed.positions])
                turns = np.vstack([scene.bodies[0].orientation, rotation.from_matrix(placed.turns)])
                if judge.overlaps(positions, turns).deepest <= 1e-6:
                    best, at = score, posture.angles
    starts = [posture_of(user), *(scattered(tree, posture_of(user), 0.5, random) for _ in range(6))]
    found = nearest_one(problem, starts)
    assert best < np.inf and found.offset > 0.01
    # a little better than the finest grid, never worse
    assert best * 0.99 - 1e-9 <= found.score <= best + 1e-9


def test_a_user_beyond_the_limits_is_met_inside_them():
    scene = wall_scene(mixed())
    problem = problem_of(scene, posed(scene, np.random.default_rng(4), 1.0))
    found = descend(problem, posture_of(posed(scene, np.random.default_rng(5), 0.1)))
    assert found.allowed and 0.0 < found.score < np.inf
    angles = found.posture.angles
    assert (problem.tree.limits[:, 0] <= angles).all() and (angles <= problem.tree.limits[:, 1]).all()


def test_where_nothing_is_allowed_there_is_no_nearest():
    scene = wall_scene(fist())
    sample = TrackerSample(0.0, np.array([[WALL + 0.1, 0.0, 0.0]]), np.array([rotation.IDENTITY]), np.zeros(0))
    # the region is the inside of the wall
    assert nearest(problem_of(scene, sample, low=WALL + 0.05, high=WALL + 0.15), [posture_of(sample)]) is None
