"""Figure 4: translation by PD_g in a "reasonable" case (a), and in a pathological one (b), where the normals cancel."""

import numpy as np
import pytest

from avatarsim.paper.state import CANCELLED, HELD, ROUNDS, WALKED_BACK
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, Piece
from tests.worlds.arms import ball_hand
from tests.worlds.loops import Loop

pytestmark = [pytest.mark.nojit]

RADIUS = 0.1
TABLE = (Piece(Box((1.0, 1.0, 0.1)), (0.0, 0.0, -0.05)), Piece(Box((0.1, 1.0, 1.0)), (-0.55, 0.0, 0.0)))


def test_several_pieces_overlapped_little_take_translation_only():
    loop = Loop((ball_hand(RADIUS),), (fixed("table", TABLE, "wood"),), roots=[(0.3, 0.0, 0.5)])
    loop.frame(roots=[(0.3, 0.0, 0.06)], frames=200)
    assert overlapping_pairs(loop.world) == []
    # out by the shortest way, and otherwise where the user is
    assert loop.world.posture.root[0] == pytest.approx([0.3, 0.0, RADIUS], abs=2e-4)
    assert loop.count(WALKED_BACK) == 0


def test_in_the_corner_of_two_pieces_the_loop_repeats():
    loop = Loop((ball_hand(RADIUS),), (fixed("table", TABLE, "wood"),), roots=[(0.3, 0.0, 0.5)])
    loop.frame(roots=[(-0.45, 0.0, 0.05)], frames=200)
    assert overlapping_pairs(loop.world) == []
    assert loop.world.posture.root[0] == pytest.approx([-0.5 + RADIUS, 0.0, RADIUS], abs=1e-3)
    assert loop.memory.counts[ROUNDS] > 1


def slot(half_width):
    """Return two plates, one body, that leave a slot narrower than the ball; its middle is the plane x = 0."""
    plates = tuple(Piece(Box((1.0, 2.0, 2.0)), (side * (0.5 + half_width), 0.0, -1.0)) for side in (-1.0, 1.0))
    return fixed("slot", plates, "wood")


def test_normals_that_cancel_are_reported_and_walked_back():
    loop = Loop((ball_hand(RADIUS),), (slot(0.09),), roots=[(0.0, 0.0, 0.5)], settings={"couple": 0})
    loop.frame(roots=[(0.0, 0.0, -0.5)])
    assert overlapping_pairs(loop.world) == []
    assert loop.memory.counts[CANCELLED] > 0
    assert loop.memory.counts[WALKED_BACK] == 1
    assert loop.memory.counts[HELD] == 0
    # the ball came down the middle until it touched both edges: 0.1^2 = 0.09^2 + z^2
    touching = np.sqrt(RADIUS**2 - 0.09**2)
    # bisection to a millionth of a way of 1 m, from the free side
    assert touching <= loop.world.posture.root[0, 2] <= touching + 1.1e-6
