"""Coach and trainee in closed form: what is left of the way after t seconds is exp(-rate t), at any frame rate."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from avatarsim.model.joint_limits import cone_excess
from avatarsim.model.skeleton import Posture
from avatarsim.paper.attraction import attract, share_of_way
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import columns
from tests.worlds.arms import arm, ball_hand, limited_ball, planar, world_of

pytestmark = [pytest.mark.nojit]

HAND = ball_hand(0.1)
ARM = arm((0.4, 0.3), [limited_ball(), planar((-0.5, 2.0))[0]], at=(5.0, 0.0, 0.0))
RATE = 30.0


def copied(posture):
    return Posture(*(array.copy() for array in posture))


def target_of(world, angle=0.0, turn=(0.0, 0.0, 0.0), root=(0.0, 0.0, 0.0)):
    target = copied(world.posture)
    target.angle[-1] = angle
    for link in range(len(target.turn)):
        target.turn[link] = rotation.to_matrix(rotation.from_rotation_vector(turn))
    target.root[0] = root
    return target


def angle_between(a, b):
    return float(np.linalg.norm(rotation.to_rotation_vector(rotation.from_matrix(a.T @ b))))


@given(st.floats(1e-6, 0.1), st.floats(1e-6, 0.1), st.floats(0.0, 200.0))
@hypothesis_settings(deadline=None)
def test_two_frames_leave_what_one_long_frame_leaves(dt, other, rate):
    left = (1.0 - share_of_way(rate, dt)) * (1.0 - share_of_way(rate, other))
    assert left == pytest.approx(1.0 - share_of_way(rate, dt + other), rel=1e-12, abs=1e-15)


def test_the_share_of_a_tiny_frame_is_not_lost_in_rounding():
    assert share_of_way(RATE, 1e-12) == pytest.approx(3e-11, rel=1e-10)


@pytest.mark.parametrize("frames", [1, 7, 60])
def test_a_released_posture_returns_exponentially(frames):
    world, seconds = world_of((HAND, ARM)), 0.1
    turn = (0.1, -0.5, 0.4)
    target = target_of(world, 1.5, turn, (1.0, 2.0, 3.0))
    for _ in range(frames):
        attract(world.skeleton, target, share_of_way(RATE, seconds / frames), world.posture)
    left = np.exp(-RATE * seconds)
    assert target.angle[-1] - world.posture.angle[-1] == pytest.approx(1.5 * left, rel=1e-12)
    for link in (0, 1):
        assert angle_between(world.posture.turn[link], target.turn[link]) == pytest.approx(np.linalg.norm(turn) * left, rel=1e-9)
    # the place of a free root is handed in, by eq. 6
    assert world.posture.root[0].tolist() == [1.0, 2.0, 3.0]


def test_a_steady_tracker_speed_leaves_the_stated_offset():
    world, dt, speed = world_of((ARM,)), 1.0 / 60.0, 0.4
    for frame in range(200):
        target = target_of(world, speed * dt * frame)
        attract(world.skeleton, target, share_of_way(RATE, dt), world.posture)
    lag = target.angle[-1] - world.posture.angle[-1]
    assert lag == pytest.approx(speed * dt / np.expm1(RATE * dt), rel=1e-9)


def test_a_tracker_beyond_the_limits_is_followed_to_the_limit_exactly():
    world = world_of((ARM,))
    target = target_of(world, 9.0, (0.0, 0.0, 2.9))
    for _ in range(300):
        attract(world.skeleton, target, 0.3, world.posture)
        assert world.posture.angle[-1] <= 2.0
        assert cone_excess(world.skeleton, 0, columns(world.posture.turn, 0)) <= 0.0
    assert world.posture.angle[-1] == pytest.approx(2.0, abs=1e-12)
    assert cone_excess(world.skeleton, 0, columns(world.posture.turn, 0)) >= -1e-8


def test_the_whole_way_in_one_frame_is_the_tracker_itself():
    world = world_of((ARM,))
    target = target_of(world, 1.25, (0.2, 0.3, -0.1))
    attract(world.skeleton, target, 1.0, world.posture)
    assert world.posture.angle[-1] == 1.25
    np.testing.assert_allclose(world.posture.turn[0], target.turn[0], atol=1e-14)
