"""The search for overlapping pairs against its dumb twin, and what it must never call free."""

import numpy as np
import pytest

from avatarsim.model.geometry import place
from avatarsim.paper.push_apart import ASKED, NOT_CHECKED, answer_for, find_overlaps, make_overlaps
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.shape import Box, Piece, Sphere
from tests.worlds.arms import ball_hand, world_of

pytestmark = [pytest.mark.nojit]

CUBE, BALL = Piece(Box((0.4, 0.4, 0.4))), Piece(Sphere(0.2))


def crowd():
    bodies = (fixed("cube", (CUBE,), "wood"), simulated("ball", (BALL,), "wood", solid((BALL,), 1.0)))
    return world_of(tuple(ball_hand(0.15, f"hand{k}") for k in range(5)), bodies)


def put(world, body, position):
    world.poses.position[body] = position
    place(world.geometry, world.poses, body)


def test_it_finds_what_trying_every_pair_finds():
    world, rng, seen = crowd(), np.random.default_rng(4), 0
    found = make_overlaps(world.geometry, world.skeleton.first)
    names = world.scene.names
    for _ in range(200):
        for body in range(7):
            put(world, body, rng.uniform(-0.5, 0.5, 3))
        count = find_overlaps(world.geometry, world.poses, found)
        listed = {frozenset(names[body] for body in pair) for pair in found.found[:count]}
        everything = {frozenset((a, b)) for a, b, _ in overlapping_pairs(world)}
        # cube and ball are none of the driven loop's business
        assert listed == everything - {frozenset(("cube", "ball"))}
        assert {names[body] for body in np.flatnonzero(found.hit)} == {name for pair in listed for name in pair}
        seen += len(listed)
    assert seen > 300


def test_a_body_that_gave_way_is_answered_for_until_it_is_let_go():
    world = crowd()
    found = make_overlaps(world.geometry, world.skeleton.first)
    for body in range(7):
        put(world, body, [3.0 * body, 0.0, 0.0])
    put(world, 1, [0.1, 0.0, 0.0])
    assert find_overlaps(world.geometry, world.poses, found) == 0
    answer_for(1, True, found)
    assert find_overlaps(world.geometry, world.poses, found) == 1
    answer_for(1, False, found)
    assert find_overlaps(world.geometry, world.poses, found) == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_pose_that_is_no_number_is_never_free(bad):
    world = crowd()
    found = make_overlaps(world.geometry, world.skeleton.first)
    for body in range(7):
        put(world, body, [3.0 * body, 0.0, 0.0])
    # uncompiled, numpy warns of what the kernels test for
    with np.errstate(invalid="ignore"):
        put(world, 4, [bad, 0.0, 0.0])
        assert find_overlaps(world.geometry, world.poses, found) == NOT_CHECKED


@pytest.mark.parametrize(("gap", "count"), [(-1e-12, 1), (1e-12, 0)])
def test_it_tells_a_billionth_of_a_millimetre_either_way(gap, count):
    world = crowd()
    found = make_overlaps(world.geometry, world.skeleton.first)
    for body in range(7):
        put(world, body, [3.0 * body, 0.0, 0.0])
    # aslant, so that their boxes meet
    put(world, 3, np.array([6.0, 0.0, 0.0]) + (0.3 + gap) * np.array([0.6, 0.8, 0.0]))
    found.tally[:] = 0
    assert find_overlaps(world.geometry, world.poses, found) == count
    assert found.tally[ASKED] >= 1
