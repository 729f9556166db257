"""Algorithm 1: cull, depth per convex pair, eq. 1, and, if needed, back between the last state and this one: step by step."""

import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CONVERGED
from avatarsim.model.geometry import place
from avatarsim.paper.push_apart import global_depth
from avatarsim.paper.state import WALKED_BACK
from avatarsim.pose_queries import meeting_pairs, overlapping_pairs
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, Piece
from tests.worlds.arms import ball_hand, world_of
from tests.worlds.loops import Loop

pytestmark = [pytest.mark.nojit]

RADIUS = 0.2
STAY = (0.0, 0.0, 0.0)
ELL = (Piece(Box((2.0, 2.0, 1.0)), (0.0, 0.0, -0.5)), Piece(Box((1.0, 2.0, 2.0)), (-1.5, 0.0, 0.0)))
"""A floor whose top is z = 0, and a wall whose face is x = -1; one body of two pieces."""


def world_at(x: float, z: float):
    world = world_of((ball_hand(RADIUS),), (fixed("ell", ELL, "wood"), fixed("far", ELL, "wood", (50.0, 0.0, 0.0))))
    world.poses.position[2] = (x, 0.0, z)
    place(world.geometry, world.poses, 2)
    return world


def depths(world) -> list[float]:
    return [max(0.0, -signed_distance(world.poses.vertices, world.geometry.shapes, piece, 4, STAY, make_scratch())[1])
            for piece in (0, 1)]


def test_step_1_pairs_that_do_not_overlap_are_culled():
    world = world_at(0.0, RADIUS - 0.05)
    # the far body is never tested; the near one overlaps with one of its two pieces
    assert meeting_pairs(world) == [(0, 2)]
    assert [pair[:2] for pair in overlapping_pairs(world)] == [("ell", "hand")]
    status, _, count = global_depth(
        world.poses.vertices, world.geometry.shapes, world.geometry.first_shape, 0, 2, make_scratch()
    )
    assert status == CONVERGED and count == 1


def test_step_2_every_convex_pair_has_its_depth():
    assert depths(world_at(-1.0 + RADIUS - 0.03, RADIUS - 0.05)) == pytest.approx([0.05, 0.03], abs=1e-12)


def test_step_3_their_squares_along_their_normals_over_their_sum():
    world = world_at(-1.0 + RADIUS - 0.03, RADIUS - 0.05)
    status, found, count = global_depth(
        world.poses.vertices, world.geometry.shapes, world.geometry.first_shape, 0, 2, make_scratch()
    )
    # normals point out of B, the ball, into A, the body: down, and against x
    wanted = (0.05**2 * np.array([0.0, 0.0, -1.0]) + 0.03**2 * np.array([-1.0, 0.0, 0.0])) / (0.05 + 0.03)
    assert status == CONVERGED and count == 2
    assert found == pytest.approx(wanted.tolist(), abs=1e-12)


def test_step_4_without_direction_the_state_goes_back():
    plates = tuple(Piece(Box((1.0, 2.0, 2.0)), (side * 0.65, 0.0, -1.0)) for side in (-1.0, 1.0))
    loop = Loop((ball_hand(RADIUS),), (fixed("slot", plates, "wood"),), roots=[(0.0, 0.0, 0.5)], settings={"couple": 0})
    world = loop.world
    loop.frame(roots=[(0.0, 0.0, -0.5)])
    assert loop.memory.counts[WALKED_BACK] == 1 and overlapping_pairs(world) == []
    # down the middle until it touches both edges
    assert world.posture.root[0, 2] == pytest.approx(np.sqrt(RADIUS**2 - 0.15**2), abs=1.1e-6)
