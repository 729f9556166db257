"""Method `paper` as the frame sees it."""

import numpy as np
import pytest

from avatarsim.model.world import Target
from avatarsim.paper.method import PaperLoop
from avatarsim.paper.state import COUNT_NAMES
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
from tests.worlds.arms import ball_hand, world_of

pytestmark = [pytest.mark.nojit]

DT = 1.0 / 60.0
BALL = (Piece(Sphere(0.1)),)
FREE_BALL = simulated("ball", BALL, "wood", solid(BALL, 1.0), (3.0, 0.0, 0.0))
WALL = fixed("wall", (Piece(Box((1.0, 4.0, 4.0)), (1.0, 0.0, 0.0)),), "wood")
"""Begins at x = 0.5."""


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
    # at the wall the user goes on and the hand does not
    assert abs(loop.world.velocities.linear[2, 0]) < 1e-6


def test_without_simulated_bodies_no_velocity_is_worked_out():
    loop = hand_before(WALL)
    loop.follow(target(loop, 0.1), DT)
    assert not loop.world.velocities.linear.any()


def test_an_impulse_displaces_the_hand_and_the_spring_brings_it_back():
    loop = hand_before(FREE_BALL)
    loop.follow(target(loop, 0.0), DT)
    impulses = np.zeros((2, 3))
    impulses[1] = (0.0, -0.2, 0.0)
    loop.receive(impulses, np.zeros(2, dtype=np.int64), target(loop, 0.0))
    # eq. 6, critically damped with 0.4 kg: y = v t e^(-50 t), v = -0.2 / 0.4
    for frame in range(1, 10):
        loop.follow(target(loop, 0.0), DT)
        t = frame * DT
        assert loop.world.posture.root[0, 1] == pytest.approx(-0.5 * t * np.exp(-50.0 * t), rel=1e-9)


def test_counts_are_named_and_statuses_only_where_something_happened():
    loop = hand_before(WALL)
    loop.follow(target(loop, 0.1), DT)
    assert tuple(loop.counts()) == COUNT_NAMES
    assert loop.statuses() == {}
    broken = target(loop, np.nan)
    # uncompiled, numpy warns of what the kernels test for
    with np.errstate(invalid="ignore"):
        loop.follow(broken, DT)
    assert loop.statuses() == {"walked_back": 1, "held": 1, "not_checked": 1}
