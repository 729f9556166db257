"""Walking back: as far as needed, as few links as will do, and to the last bit where nothing else is free."""

import numpy as np
import pytest

from avatarsim.model.geometry import place
from avatarsim.paper.state import GAVE_WAY, HELD, START_OVERLAPS, WALK_TESTS, WALKED_BACK, Chains
from avatarsim.paper.walk_back import AVATARS_HIT, CHAINS_HIT, EVERYTHING, choose_links
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.shape import Box, Piece, Sphere
from tests.worlds.arms import RADIUS, arm, ball_hand, planar
from tests.worlds.loops import Loop

pytestmark = [pytest.mark.nojit]

WALL = fixed("wall", (Piece(Box((4.0, 1.0, 4.0)), (0.0, 1.0, 0.0)),), "wood")
"""Fills y from 0.5 to 1.5."""
NO_ROUNDS = {"rounds": 0, "couple": 0}


def test_a_hand_stops_at_the_wall_to_a_millionth_of_its_way():
    loop = Loop((ball_hand(0.1),), (WALL,), roots=[(0.0, 0.0, 0.0)], settings=NO_ROUNDS)
    loop.frame(roots=[(0.3, 0.8, 0.0)])
    y = loop.world.posture.root[0, 1]
    assert 0.4 - 0.8e-6 <= y <= 0.4
    # back along its way, which is oblique
    assert loop.world.posture.root[0, 0] == pytest.approx(0.3 * y / 0.8, abs=1e-15)
    assert loop.memory.counts[WALKED_BACK] == 1
    # two levels tried at the checked state (a hand is on no chain), 20 halvings
    assert loop.memory.counts[WALK_TESTS] == 22
    assert overlapping_pairs(loop.world) == []


def test_only_the_arm_that_overlaps_is_walked_back():
    arms = (arm((0.6,), planar((-2.0, 2.0)), "caught"), arm((0.6,), planar((-2.0, 2.0)), "clear", at=(0.0, -2.0, 0.0)))
    loop = Loop(arms, (WALL,), settings={"rounds": 0})
    loop.frame(angles=[1.4, 1.0], frames=60)
    assert loop.count(WALKED_BACK) > 50
    assert overlapping_pairs(loop.world) == []
    # the one touches the wall with its tip, the other is where the user is
    assert loop.world.posture.angle[0] == pytest.approx(np.arcsin((0.5 - RADIUS) / 0.6), abs=1e-6)
    assert loop.world.posture.angle[1] == pytest.approx(1.0, abs=1e-9)


def test_a_body_carried_into_a_pinned_arm_is_reported_and_everything_stays():
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
    """A ball between a pinned arm and a wall it touches: pushed out of the arm it is in the wall, and back again."""
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
