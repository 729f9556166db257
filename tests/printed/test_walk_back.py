"""Walking back: states between two postures, as far back as needed, with as few links as possible, and inside limits."""

import numpy as np
import pytest

from avatarsim.model.geometry import place
from avatarsim.model.joint_limits import cone_excess
from avatarsim.model.skeleton import Posture
from avatarsim.paper.state import GAVE_WAY, HELD, START_OVERLAPS, WALK_TESTS, WALKED_BACK, Chains
from avatarsim.paper.walk_back import AVATARS_HIT, CHAINS_HIT, EVERYTHING, choose_links, interpolate, into_limits, narrowed
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import columns
from tests.worlds.arms import RADIUS, arm, ball_hand, limited_ball, planar, world_of
from tests.worlds.loops import Loop

pytestmark = [pytest.mark.nojit]

AVATARS = (ball_hand(0.1), arm((0.4, 0.3), [limited_ball(), planar((-0.5, 2.0))[0]], at=(3.0, 0.0, 0.0)))
ALL = np.ones(3, dtype=np.bool_)


def some_posture(world, seed):
    rng = np.random.default_rng(seed)
    q = rotation.normalised(rng.normal(size=(3, 4)))
    return Posture(rng.normal(size=(3, 3)), rotation.to_matrix(q), rng.uniform(-0.5, 2.0, len(world.posture.angle))), q


@pytest.mark.parametrize("fraction", [0.25, 0.5, 0.9])
def test_hinges_go_straight_and_rotations_on_great_circles(fraction):
    world = world_of(AVATARS)
    (a, qa), (b, qb) = some_posture(world, 1), some_posture(world, 2)
    interpolate(world.skeleton, a, b, fraction, ALL, world.posture)
    hinge = len(world.posture.angle) - 1
    assert world.posture.angle[hinge] == pytest.approx((1 - fraction) * a.angle[hinge] + fraction * b.angle[hinge])
    np.testing.assert_allclose(world.posture.root[0], (1 - fraction) * a.root[0] + fraction * b.root[0], atol=1e-15)
    for link in (0, 1):
        # the plain reference version works on quaternions
        np.testing.assert_allclose(
            world.posture.turn[link], rotation.to_matrix(rotation.slerp(qa[link], qb[link], fraction)), atol=1e-12
        )


def test_the_ends_are_the_ends_bit_for_bit():
    world = world_of(AVATARS)
    (a, _), (b, _) = some_posture(world, 1), some_posture(world, 2)
    broken = Posture(*(np.full_like(array, np.nan) for array in b))
    interpolate(world.skeleton, a, broken, 0.0, ALL, world.posture)
    assert (world.posture.root[0] == a.root[0]).all()
    assert (world.posture.turn[:2] == a.turn[:2]).all()
    assert world.posture.angle[-1] == a.angle[-1]
    interpolate(world.skeleton, broken, b, 1.0, ALL, world.posture)
    assert (world.posture.root[0] == b.root[0]).all()
    assert (world.posture.turn[:2] == b.turn[:2]).all()
    assert world.posture.angle[-1] == b.angle[-1]


def test_links_that_are_not_chosen_keep_the_present_posture():
    world = world_of(AVATARS)
    (a, _), (b, _) = some_posture(world, 1), some_posture(world, 2)
    interpolate(world.skeleton, a, b, 0.0, np.array([False, True, False]), world.posture)
    assert (world.posture.root[0] == b.root[0]).all()
    assert (world.posture.turn[1] == a.turn[1]).all()
    assert world.posture.angle[-1] == b.angle[-1]


@pytest.mark.parametrize("edge", [0.0, 1e-5, 0.3, 0.7853981, 0.999])
def test_bisection_finds_the_edge_from_the_free_side(edge):
    low, high = 0.0, 1.0
    while high - low > 1e-6:
        low, high = narrowed(low, high, 0.5 * (low + high) <= edge)
    assert low <= edge <= low + 1e-6


WALL = fixed("wall", (Piece(Box((4.0, 1.0, 4.0)), (0.0, 1.0, 0.0)),), "wood")
"""A wall that fills y from 0.5 to 1.5."""
NO_ROUNDS = {"rounds": 0, "couple": 0}


def test_a_hand_stops_at_the_wall_to_a_millionth_of_its_way():
    loop = Loop((ball_hand(0.1),), (WALL,), roots=[(0.0, 0.0, 0.0)], settings=NO_ROUNDS)
    loop.frame(roots=[(0.3, 0.8, 0.0)])
    y = loop.world.posture.root[0, 1]
    assert 0.4 - 0.8e-6 <= y <= 0.4
    # back along its oblique path
    assert loop.world.posture.root[0, 0] == pytest.approx(0.3 * y / 0.8, abs=1e-15)
    assert loop.memory.counts[WALKED_BACK] == 1
    # two levels at the checked state (a hand is on no chain), 20 halvings
    assert loop.memory.counts[WALK_TESTS] == 22
    assert overlapping_pairs(loop.world) == []


def test_only_the_arm_that_overlaps_is_walked_back():
    arms = (arm((0.6,), planar((-2.0, 2.0)), "caught"), arm((0.6,), planar((-2.0, 2.0)), "clear", at=(0.0, -2.0, 0.0)))
    loop = Loop(arms, (WALL,), settings={"rounds": 0})
    loop.frame(angles=[1.4, 1.0], frames=60)
    assert loop.count(WALKED_BACK) > 50
    assert overlapping_pairs(loop.world) == []
    # one touches the wall with its tip, the other is at the user's posture
    assert loop.world.posture.angle[0] == pytest.approx(np.arcsin((0.5 - RADIUS) / 0.6), abs=1e-6)
    assert loop.world.posture.angle[1] == pytest.approx(1.0, abs=1e-9)


def test_a_body_carried_into_a_pinned_arm_is_reported():
    ball = (Piece(Sphere(0.2)),)
    loop = Loop(
        (arm((0.4,), planar((0.0, 0.0))),), (simulated("ball", ball, "wood", solid(ball, 1.0), (0.2, 0.3, 0.0)),),
        settings={"patience": 99},
    )
    loop.world.poses.position[0, 1] = 0.15
    place(loop.world.geometry, loop.world.poses, 0)
    loop.frame(angles=[0.0])
    assert loop.memory.counts[START_OVERLAPS] == 1
    assert loop.memory.counts[HELD] == 1
    assert loop.count(GAVE_WAY) == 0
    assert loop.world.poses.position[0].tolist() == [0.2, 0.15, 0.0]


def test_a_body_that_gave_way_in_vain_is_walked_back_too():
    """A ball between a pinned arm and a wall that it touches: moved out of the arm it is in the wall, and vice versa."""
    ball = (Piece(Sphere(0.2)),)
    loop = Loop(
        (ball_hand(0.1),), (WALL, simulated("ball", ball, "wood", solid(ball, 1.0), (0.0, 0.2999, 0.0))),
        roots=[(0.0, -0.2, 0.0)], settings={"couple": 0, "patience": 0},
    )
    loop.frame(roots=[(0.0, 0.1, 0.0)])
    assert overlapping_pairs(loop.world) == []
    assert loop.count(GAVE_WAY) > 0
    assert loop.memory.counts[START_OVERLAPS] == 0
    assert loop.world.poses.position[1, 1] <= 0.3


def test_everything_ends_inside_its_limits():
    world = world_of((arm((0.4, 0.3), [limited_ball(), planar((-0.5, 2.0))[0]]),))
    rng, kept = np.random.default_rng(3), 0
    for _ in range(500):
        world.posture.turn[0] = rotation.to_matrix(rotation.from_rotation_vector(rng.normal(size=3)))
        world.posture.angle[:] = rng.normal(size=4)
        before = [world.posture.turn[0].copy(), world.posture.angle.copy()]
        was_inside = cone_excess(world.skeleton.balls, 0, columns(world.posture.turn, 0)) < -1e-6
        into_limits(world.skeleton, world.posture)
        assert cone_excess(world.skeleton.balls, 0, columns(world.posture.turn, 0)) <= 0.0
        assert -0.5 <= world.posture.angle[3] <= 2.0
        if was_inside:
            kept += 1
            assert (world.posture.turn[0] == before[0]).all()
        if -0.5 <= before[1][3] <= 2.0:
            assert world.posture.angle[3] == before[1][3]
    assert 50 < kept < 450


def test_levels_take_in_more_and_more():
    # chains of links (1, 2) and (3), root 0; another avatar is link 4
    chains = Chains(
        np.array([0, 2, 3, 4]), np.array([1, 2, 3, 4]), np.array([True, False, False, False, False]), np.array([0, 0, 0, 0, 4]),
        np.zeros((5, 3)),
    )
    hit, chosen = np.array([True, False, False, True, False, False]), np.ones(5, dtype=np.bool_)
    choose_links(chains, hit, 1, CHAINS_HIT, chosen)
    assert chosen.tolist() == [False, True, True, False, False]
    choose_links(chains, hit, 1, AVATARS_HIT, chosen)
    assert chosen.tolist() == [True, True, True, True, False]
    choose_links(chains, hit, 1, EVERYTHING, chosen)
    assert chosen.all()
