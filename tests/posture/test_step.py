"""The budget of a frame: as set for a few near pairs, growing with every further one."""

import numpy as np
import pytest

from avatarsim.posture.certify import certify
from avatarsim.posture.kinematics import forward
from avatarsim.posture.step import PAIRS_INCLUDED, SHRINK, WORK_PER_PAIR, budget, go_less_far
from avatarsim.posture.workspace import ASKED, HELD, NEAR
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from tests.posture.little_worlds import SETTINGS, Little, little


def beside_wall(balls: int) -> Little:
    """A hand of so many balls in a row, each 1 mm before a wall."""
    pieces = tuple(Piece(Sphere(0.02), (0.0, 0.05 * k, 0.0)) for k in range(balls))
    wall = fixed("wall", (Piece(Box((0.1, 4.0, 1.0))),), "wood", (0.071, 0.0, 0.0))
    return little(Scene("s", (wall,), (rigid_avatar("hand", pieces, solid(pieces, 0.5)),)))


@pytest.mark.nojit
@pytest.mark.parametrize("balls", [1, PAIRS_INCLUDED, 30])
def test_the_budget_grows_with_the_near_pairs_of_the_last_trial(balls: int) -> None:
    found = beside_wall(balls)
    geo, skel, posture, poses = found.parts
    assert budget(SETTINGS, found.memory) == SETTINGS.work
    found.memory.rows.x[:] = [0.005, 0.0, 0.0, 0.0, 0.0, 0.0]
    for _ in range(2):
        # twice: a trial counts its own pairs, not those of the trial before
        forward(geo, skel, posture, found.memory.rows.x, found.memory.trial, found.memory.trial_axes)
        assert certify(geo, skel, poses, SETTINGS, found.memory) == balls
        assert found.memory.pairs.marks[ASKED] == balls
    assert found.memory.counts[NEAR] == 2 * balls
    assert budget(SETTINGS, found.memory) == SETTINGS.work + WORK_PER_PAIR * max(0, balls - PAIRS_INCLUDED)


@pytest.mark.nojit
def test_a_trial_that_is_no_pose_asks_nobody() -> None:
    found = beside_wall(30)
    geo, skel, posture, poses = found.parts
    found.memory.rows.x[:] = np.nan
    forward(geo, skel, posture, found.memory.rows.x, found.memory.trial, found.memory.trial_axes)
    assert certify(geo, skel, poses, SETTINGS, found.memory) == 1
    assert budget(SETTINGS, found.memory) == SETTINGS.work


@pytest.mark.nojit
@pytest.mark.parametrize(("overshot", "kept"), [(3.0, 3.0 * SHRINK), (9.0, 0.0), (-3.0, 0.0)])
def test_a_step_that_goes_too_far_is_shortened_and_one_that_leads_away_is_not_taken(overshot: float, kept: float) -> None:
    found = beside_wall(1)
    geo, skel, posture, poses = found.parts
    memory, way = found.memory, np.array([-1e-3, 0.0, 0.0, 0.0, 0.0, 0.0])
    memory.goal.full[:], memory.rows.x[:] = way, overshot * way
    go_less_far(geo, skel, posture, poses, SETTINGS, memory)
    assert memory.rows.x == pytest.approx(kept * way, abs=1e-15) and memory.counts[HELD] == (kept == 0.0)
    assert memory.trial.position[skel.first] == pytest.approx(poses.position[skel.first] + kept * way[:3], abs=1e-15)


@pytest.mark.nojit
def test_a_shortened_step_into_a_wall_is_not_taken() -> None:
    found = beside_wall(1)
    geo, skel, posture, poses = found.parts
    memory, way = found.memory, np.array([0.02, 0.0, 0.0, 0.0, 0.0, 0.0])
    memory.goal.full[:], memory.rows.x[:] = way, way
    go_less_far(geo, skel, posture, poses, SETTINGS, memory)
    assert not memory.rows.x.any() and memory.counts[HELD] == 1
