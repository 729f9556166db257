"""A step is shortened to the millimetre along itself; a short one is left alone; rest is counted in frames."""

import numpy as np
import pytest

from avatarsim.posture.creep import CREEP, CREEP_AFTER, creeps, farthest_moved, slow_down
from avatarsim.posture.kinematics import forward
from avatarsim.posture.workspace import LED, RESTED, UNDER_WAY
from avatarsim.scene.scene import Scene
from tests.posture.little_worlds import Little, little, mixed_avatar


def stepped(step: np.ndarray) -> Little:
    """An avatar with every kind of joint, and the trial of a step."""
    found = little(Scene("s", (), (mixed_avatar(),)))
    geo, skel, posture, _ = found.parts
    found.memory.rows.x[:] = step
    forward(geo, skel, posture, found.memory.rows.x, found.memory.trial, found.memory.trial_axes)
    return found


@pytest.mark.nojit
@pytest.mark.parametrize("size", [0.01, 0.3, 2.5])
@pytest.mark.parametrize("seed", range(4))
def test_a_long_step_becomes_a_short_one_along_itself(size: float, seed: int) -> None:
    step = np.random.default_rng(seed).uniform(-size, size, len(little(Scene("s", (), (mixed_avatar(),))).memory.rows.x))
    found = stepped(step)
    geo, skel, posture, poses = found.parts
    slow_down(geo, skel, posture, poses, found.memory)
    x = found.memory.rows.x
    np.testing.assert_allclose(x * (step @ step), step * (x @ step), atol=1e-15 * size)
    assert 0.5 * CREEP < farthest_moved(skel, poses, found.memory) <= CREEP * (1.0 + 1e-6)
    shown = found.memory.trial.position[skel.first :] - poses.position[skel.first :]
    assert np.linalg.norm(shown, axis=1).max() <= CREEP * (1.0 + 1e-6)


@pytest.mark.nojit
def test_a_short_step_is_left_alone() -> None:
    step = np.full(len(little(Scene("s", (), (mixed_avatar(),))).memory.rows.x), 1e-5)
    found = stepped(step)
    geo, skel, posture, poses = found.parts
    slow_down(geo, skel, posture, poses, found.memory)
    np.testing.assert_array_equal(found.memory.rows.x, step)


@pytest.mark.nojit
def test_who_has_rested_long_enough_creeps() -> None:
    memory = little(Scene("s", (), (mixed_avatar(),))).memory
    memory.flags[RESTED] = CREEP_AFTER - 1
    assert not creeps(memory)
    memory.flags[RESTED] = CREEP_AFTER
    assert creeps(memory)


@pytest.mark.nojit
def test_nobody_creeps_along_a_way_that_was_found() -> None:
    memory = little(Scene("s", (), (mixed_avatar(),))).memory
    memory.flags[RESTED], memory.flags[LED] = CREEP_AFTER, UNDER_WAY
    assert not creeps(memory)
    memory.flags[LED] = 0.0
    assert creeps(memory)
