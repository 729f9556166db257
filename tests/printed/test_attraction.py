"""Motion to the tracker in closed form: attraction of joints, eq. 6 of roots, and both as the frame calls them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from avatarsim.model.joint_limits import cone_excess
from avatarsim.model.skeleton import BALL, FREE, Posture
from avatarsim.model.world import Target
from avatarsim.paper.attraction import attract, couple_roots, settle_roots, share_of_distance
from avatarsim.paper.method import PaperLoop
from avatarsim.paper.state import COUNT_NAMES
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
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
    left = (1.0 - share_of_distance(rate, dt)) * (1.0 - share_of_distance(rate, other))
    assert left == pytest.approx(1.0 - share_of_distance(rate, dt + other), rel=1e-12, abs=1e-15)


def test_the_share_of_a_tiny_frame_is_not_lost_in_rounding():
    assert share_of_distance(RATE, 1e-12) == pytest.approx(3e-11, rel=1e-10)


@pytest.mark.parametrize("frames", [1, 7, 60])
def test_a_released_posture_returns_exponentially(frames):
    world, seconds = world_of((HAND, ARM)), 0.1
    turn = (0.1, -0.5, 0.4)
    target = target_of(world, 1.5, turn, (1.0, 2.0, 3.0))
    for _ in range(frames):
        attract(world.skeleton, target, share_of_distance(RATE, seconds / frames), world.posture)
    left = np.exp(-RATE * seconds)
    assert target.angle[-1] - world.posture.angle[-1] == pytest.approx(1.5 * left, rel=1e-12)
    for link in (0, 1):
        assert angle_between(world.posture.turn[link], target.turn[link]) == pytest.approx(np.linalg.norm(turn) * left, rel=1e-9)
    # the position of a free root is an argument, by eq. 6
    assert world.posture.root[0].tolist() == [1.0, 2.0, 3.0]


def test_a_steady_tracker_speed_leaves_the_stated_offset():
    world, dt, speed = world_of((ARM,)), 1.0 / 60.0, 0.4
    for frame in range(200):
        target = target_of(world, speed * dt * frame)
        attract(world.skeleton, target, share_of_distance(RATE, dt), world.posture)
    lag = target.angle[-1] - world.posture.angle[-1]
    assert lag == pytest.approx(speed * dt / np.expm1(RATE * dt), rel=1e-9)


def test_a_tracker_beyond_limits_is_followed_to_the_limit():
    world = world_of((ARM,))
    target = target_of(world, 9.0, (0.0, 0.0, 2.9))
    for _ in range(300):
        attract(world.skeleton, target, 0.3, world.posture)
        assert world.posture.angle[-1] <= 2.0
        assert cone_excess(world.skeleton.balls, 0, columns(world.posture.turn, 0)) <= 0.0
    assert world.posture.angle[-1] == pytest.approx(2.0, abs=1e-12)
    assert cone_excess(world.skeleton.balls, 0, columns(world.posture.turn, 0)) >= -1e-8


def test_the_whole_way_in_one_frame_is_the_tracker_itself():
    world = world_of((ARM,))
    target = target_of(world, 1.25, (0.2, 0.3, -0.1))
    attract(world.skeleton, target, 1.0, world.posture)
    assert world.posture.angle[-1] == 1.25
    np.testing.assert_allclose(world.posture.turn[0], target.turn[0], atol=1e-14)


KIND = np.array([FREE, BALL], dtype=np.int64)
MASS = np.array([0.4, 1.0])
EQ_6 = CouplingSettings()


def rows(*x):
    return np.array([[value, 0.0, 0.0] for value in x])


def frame(tracker, tracked, shown, velocity, dt, couple=1):
    speed, target = rows(velocity, 0.0), rows(9.0, 9.0)
    couple_roots(KIND, rows(tracker, 5.0), rows(tracked, 5.0), rows(shown, 5.0), MASS, dt, EQ_6, couple, speed, target)
    assert target[1, 0] == 9.0 and speed[1, 0] == 0.0
    return target[0, 0], speed[0, 0]


def test_a_root_that_moves_with_its_tracker_does_not_trail():
    place, speed = frame(0.05, 0.0, 0.0, 3.0, 0.05 / 3.0)
    assert place == pytest.approx(0.05, abs=1e-15)
    assert speed == pytest.approx(3.0, abs=1e-12)


@pytest.mark.parametrize("frames", [1, 5, 100])
def test_frames_of_any_length_add_up(frames):
    place, speed, seconds = 0.1, -0.5, 0.08
    for _ in range(frames):
        place, speed = frame(0.0, 0.0, place, speed, seconds / frames)
    # critically damped: 40^2 = 4 * 0.4 * 1000
    s = 50.0
    assert place == pytest.approx((0.1 + (-0.5 + s * 0.1) * seconds) * np.exp(-s * seconds), rel=1e-9)


def test_without_coupling_or_time_the_root_is_where_the_user_is():
    assert frame(0.3, 0.0, 0.0, 0.0, 0.1, couple=0) == (0.3, 0.0)
    assert frame(0.3, 0.0, 0.0, 0.0, 0.0)[0] == 0.3


def test_a_held_root_has_the_velocity_it_was_shown_to_have():
    speed, tracked = rows(7.0, 0.0), rows(0.0, 0.0)
    settle_roots(KIND, rows(1.0, 0.0), rows(0.5, 0.0), rows(0.2, 0.0), rows(0.3, 0.0), 0.1, speed, tracked)
    assert speed[0, 0] == pytest.approx(1.0)
    assert tracked[0, 0] == 1.0
    # and one that reached the position of eq. 6 keeps the velocity of eq. 6
    speed = rows(7.0, 0.0)
    settle_roots(KIND, rows(1.0, 0.0), rows(0.3, 0.0), rows(0.2, 0.0), rows(0.3, 0.0), 0.1, speed, tracked)
    assert speed[0, 0] == 7.0


def test_a_tracker_that_is_no_number_is_not_remembered():
    speed, tracked = rows(np.nan, 0.0), rows(0.0, 0.0)
    settle_roots(KIND, rows(np.nan, 0.0), rows(np.nan, 0.0), rows(0.2, 0.0), rows(0.2, 0.0), 0.1, speed, tracked)
    assert (speed[0, 0], tracked[0, 0]) == (0.0, 0.2)


DT = 1.0 / 60.0
SPHERE = (Piece(Sphere(0.1)),)
FREE_BALL = simulated("ball", SPHERE, "wood", solid(SPHERE, 1.0), (3.0, 0.0, 0.0))
WALL = fixed("wall", (Piece(Box((1.0, 4.0, 4.0)), (1.0, 0.0, 0.0)),), "wood")
"""A wall whose surface begins at x = 0.5."""


def hand_before(*bodies):
    world = world_of((ball_hand(0.1),), bodies)
    return PaperLoop(world, PaperSettings(), CouplingSettings(), AttractionSettings(), 1)


def target(loop, x):
    wanted = Target(loop.world)
    for mine, theirs in zip(wanted.posture, loop.world.posture, strict=True):
        mine[:] = theirs
    wanted.posture.root[0] = (x, 0.0, 0.0)
    return wanted


def test_links_get_the_velocity_of_the_way_they_were_shown_to_go():
    loop = hand_before(WALL, FREE_BALL)
    for frame in range(1, 40):
        before = loop.world.poses.position[2, 0]
        loop.follow(target(loop, 0.02 * frame), DT)
        assert overlapping_pairs(loop.world) == []
        shown = loop.world.poses.position[2, 0] - before
        assert loop.world.velocities.linear[2, 0] == pytest.approx(shown / DT, abs=1e-9)
    # at the wall the user moves on and the hand stops
    assert abs(loop.world.velocities.linear[2, 0]) < 1e-6


def test_without_simulated_bodies_no_velocity_is_worked_out():
    loop = hand_before(WALL)
    loop.follow(target(loop, 0.1), DT)
    assert not loop.world.velocities.linear.any()


def test_an_impulse_moves_the_hand_and_the_spring_returns_it():
    loop = hand_before(FREE_BALL)
    loop.follow(target(loop, 0.0), DT)
    impulses = np.zeros((2, 3))
    impulses[1] = (0.0, -0.2, 0.0)
    loop.receive(impulses)
    # eq. 6, critically damped with 0.4 kg: y = v t e^(-50 t), v = -0.2 / 0.4
    for frame in range(1, 10):
        loop.follow(target(loop, 0.0), DT)
        t = frame * DT
        assert loop.world.posture.root[0, 1] == pytest.approx(-0.5 * t * np.exp(-50.0 * t), rel=1e-9)


def test_counts_are_named_and_statuses_only_where_needed():
    loop = hand_before(WALL)
    loop.follow(target(loop, 0.1), DT)
    assert tuple(loop.counts()) == COUNT_NAMES
    assert loop.statuses() == {}
    broken = target(loop, np.nan)
    # without compilation numpy warns of cases that the kernels test for
    with np.errstate(invalid="ignore"):
        loop.follow(broken, DT)
    assert loop.statuses() == {"walked_back": 1, "held": 1, "not_checked": 1}
