"""Pushing apart by PD_g: exact for two convex bodies, 1/N of the depth per pass in a corner of N walls."""

import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CANCELLING, CONVERGED
from avatarsim.model.geometry import place
from avatarsim.paper.push_apart import STAY, lengthened, push_apart
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, Piece
from tests.worlds.arms import ball_hand, world_of

pytestmark = [pytest.mark.nojit]

SCRATCH = make_scratch()
RADIUS, DEPTH = 0.2, 0.05


def walls(count):
    """One body of ``count`` walls, each filling a half space below zero along one axis as far as the ball can see."""
    pieces = []
    for axis in range(count):
        centre = [0.0, 0.0, 0.0]
        centre[axis] = -5.0
        pieces.append(Piece(Box((10.0, 10.0, 10.0)), tuple(centre)))
    return fixed("corner", tuple(pieces), "wood", (0.0, 0.0, 0.0))


def in_corner(count):
    """A driven ball that is ``DEPTH`` deep in every wall of a corner; it starts clear of it."""
    world = world_of((ball_hand(RADIUS),), (walls(count),))
    put(world, 1, [RADIUS - DEPTH if axis < count else 0.3 for axis in range(3)])
    return world


def put(world, body, position):
    world.poses.position[body] = position
    place(world.geometry, world.poses, body)


def depths(world, count):
    vertices, shapes = world.poses.vertices, world.geometry.shapes
    return -np.array([signed_distance(vertices, shapes, wall, count, STAY, SCRATCH)[1] for wall in range(count)])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_corner_of_n_walls_loses_one_nth_per_pass(count):
    world = in_corner(count)
    for passes in range(1, 6):
        status, of_wall, of_ball = push_apart(world.geometry, world.poses, 0, 1, 0.0, 1.0, 0.0, SCRATCH)
        assert of_wall == STAY
        assert status == CONVERGED
        put(world, 1, world.poses.position[1] + of_ball)
        np.testing.assert_allclose(depths(world, count), DEPTH * (1.0 - 1.0 / count) ** passes, atol=1e-9)
        if count == 1:
            break


@pytest.mark.parametrize(("share_a", "share_b"), [(0.5, 0.5), (1.0, 0.0), (0.0, 1.0), (0.25, 0.75)])
def test_shares_move_both_by_their_part_and_leave_the_stand_off(share_a, share_b):
    world, stand_off = world_of((ball_hand(RADIUS, "a"), ball_hand(RADIUS, "b"))), 1e-4
    put(world, 1, [0.3, 0.0, 0.0])
    status, of_a, of_b = push_apart(world.geometry, world.poses, 0, 1, share_a, share_b, stand_off, SCRATCH)
    assert status == CONVERGED
    assert of_a == pytest.approx((-share_a * (0.1 + stand_off), 0.0, 0.0), abs=1e-12)
    assert of_b == pytest.approx((share_b * (0.1 + stand_off), 0.0, 0.0), abs=1e-12)
    put(world, 0, world.poses.position[0] + of_a)
    put(world, 1, world.poses.position[1] + of_b)
    gap = signed_distance(world.poses.vertices, world.geometry.shapes, 0, 1, STAY, SCRATCH)[1]
    assert gap == pytest.approx(stand_off, abs=1e-12)


def test_bodies_that_do_not_overlap_stay():
    world = world_of((ball_hand(RADIUS, "a"), ball_hand(RADIUS, "b")))
    put(world, 1, [0.5, 0.0, 0.0])
    assert push_apart(world.geometry, world.poses, 0, 1, 0.5, 0.5, 1e-4, SCRATCH) == (CONVERGED, STAY, STAY)


def test_cancelling_normals_move_nothing_and_say_so():
    plates = tuple(Piece(Box((1.0, 4.0, 4.0)), (side * 0.65, 0.0, 0.0)) for side in (-1.0, 1.0))
    slot = fixed("slot", plates, "wood", (0.0, 0.0, 9.0))
    world = world_of((ball_hand(RADIUS),), (slot,))
    put(world, 1, [0.0, 0.0, 9.0])
    assert push_apart(world.geometry, world.poses, 0, 1, 0.0, 1.0, 1e-4, SCRATCH) == (CANCELLING, STAY, STAY)


def test_the_stand_off_lengthens_a_push_and_leaves_no_push_alone():
    assert lengthened((0.0, 3.0, 4.0), 1.0) == pytest.approx((0.0, 3.6, 4.8))
    assert lengthened((0.0, 0.0, 0.0), 1.0) == (0.0, 0.0, 0.0)
