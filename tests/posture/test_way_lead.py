"""A way is followed only as far as it is still free: every step of it is certified among what stands there now."""

import numpy as np
import pytest

from avatarsim.posture.motion_budget import is_spent
from avatarsim.posture.way_lead import AHEAD, lead, straight_to
from avatarsim.posture.way_memory import AT, LAST, REFUSED, Way, add_node, make_way
from avatarsim.posture.way_path import trace
from avatarsim.world.skeleton import Posture
from tests.posture.little_worlds import SETTINGS, Little, hand_scene, little, panel

pytestmark = [pytest.mark.boundscheck]
STEP = 0.1


def way_along_x(nodes: int, wall: float) -> tuple[Little, Way]:
    """A ball of 5 cm at the origin, a thin panel at x = wall, and a way of so many nodes, STEP apart along x."""
    found = little(hand_scene((0.0, 0.0, 0.0), panel(x=wall)))
    geo, skel, posture, poses = found.parts
    way = make_way(geo, skel, posture, poses, found.memory, 0)
    for k in range(nodes):
        root = posture.root.copy()
        root[0, 0] = STEP * k
        add_node(Posture(root, posture.turn, posture.angle), k - 1, way)
    trace(way)
    found.memory.goal.led[0] = 1.0
    return found, way


def place(found: Little) -> float:
    """x of the ball."""
    return float(found.world.posture.root[0, 0])


def test_a_free_way_is_gone_to_its_end_with_no_step_longer_than_allowed() -> None:
    found, way = way_along_x(12, wall=9.0)
    geo, skel, posture, poses = found.parts
    places = [place(found)]
    while way.state[AT] < way.state[LAST]:
        # each in a frame of its own
        found.memory.goal.gone[:] = 0.0
        lead(geo, skel, SETTINGS, way, posture, poses, found.memory)
        places.append(place(found))
    assert np.diff(places).max() <= SETTINGS.move_cap + 1e-12 and places[-1] == pytest.approx(11 * STEP, abs=1e-12)


def test_steps_of_one_frame_end_where_its_motion_budget_ends_and_the_next_goes_on_from_there() -> None:
    found, way = way_along_x(12, wall=9.0)
    geo, skel, posture, poses = found.parts
    goal = found.memory.goal
    # the user has moved by half a node's distance
    goal.leapt[0, 0] = 0.5 * STEP
    budget = goal.leapt[0, 0] + SETTINGS.steps * SETTINGS.move_cap
    assert not is_spent(skel, SETTINGS, goal)
    for _ in range(4):
        lead(geo, skel, SETTINGS, way, posture, poses, found.memory)
    assert place(found) == pytest.approx(budget, abs=1e-12) and way.state[AT] == 3 and way.state[REFUSED] == 0
    assert is_spent(skel, SETTINGS, goal) and goal.gone[0] == pytest.approx((budget, 0.0), abs=1e-12)
    goal.gone[:] = 0.0
    lead(geo, skel, SETTINGS, way, posture, poses, found.memory)
    assert place(found) == pytest.approx(4 * STEP, abs=1e-12) and way.state[AT] == 4


def test_several_nodes_are_skipped_where_they_are_close() -> None:
    found, way = way_along_x(8, wall=9.0)
    way.node_root[:8, 0, 0] *= 0.1
    geo, skel, posture, poses = found.parts
    lead(geo, skel, SETTINGS, way, posture, poses, found.memory)
    assert way.state[AT] == AHEAD and place(found) == pytest.approx(0.1 * AHEAD * STEP)


@pytest.mark.parametrize("wall", [0.06, 0.1, 0.12])
def test_what_stands_in_the_way_is_not_gone_into_nor_through(wall: float) -> None:
    found, way = way_along_x(6, wall)
    geo, skel, posture, poses = found.parts
    assert not straight_to(geo, skel, SETTINGS, 1, way, posture, poses, found.memory)
    assert place(found) == 0.0
    for k in range(6):
        lead(geo, skel, SETTINGS, way, posture, poses, found.memory)
        assert way.state[REFUSED] == k + 1 and way.state[AT] == 0
        assert place(found) < wall - 0.001 - 0.05
