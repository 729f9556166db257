"""A tracker that is inside something, beyond something else: what keeps the trunk off it is told apart, and walked around."""

import numpy as np
import pytest

from avatarsim.posture.goal import root_way
from avatarsim.posture.held_off import BETWEEN, FAR_OFF, INSIDE, NOTHING, what_holds_off
from avatarsim.posture.kinematics import forward
from avatarsim.posture.way_memory import make_way
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from tests.posture.little_worlds import SETTINGS, at, little
from tests.posture.test_trapped import limbed, play, pocket, slab, total

BEYOND = (0.6, 0.0, 0.0)
STONE = slab("stone", (0.5, 0.0, 0.0), (0.02, 0.02, 0.02))
"""Inside the tip of a tracker at BEYOND, and clear of its trunk."""
BLOCK = slab("block", (0.7, 0.0, 0.0), (0.4, 4.0, 4.0))
"""What a trunk at BEYOND is inside of."""
PLATE = slab("plate", (0.3, 0.0, 0.0), (0.02, 0.4, 0.4))
"""Between a trunk at the origin and one at BEYOND."""
TALL = slab("tall", (0.3, 0.13, 0.0), (0.02, 0.1, 0.4))
"""Beside that way."""


def test_a_trunk_held_off_from_a_tracker_that_is_not_free_is_led_there() -> None:
    bodies = (*pocket(), STONE)
    stays, scene = play(bodies, limbed(), (-0.1, 0.0, 0.0), [BEYOND] * 120, search_work=0)
    trunk = len(scene.bodies)
    assert BEYOND[0] - stays[-1].shown.positions[trunk, 0] > FAR_OFF and stays[-1].counts["trapped"] == 1
    goes, _ = play(bodies, limbed(), (-0.1, 0.0, 0.0), [BEYOND] * 120)
    assert np.linalg.norm(goes[-1].shown.positions[trunk] - BEYOND) < 0.1
    assert total(goes, "led") > 0 and total(goes, "crossings") == total(goes, "resyncs") == 0
    # there it is pressed on the stone, which is no trap
    assert goes[-1].counts["trapped"] == 0


def test_who_is_pressed_into_a_thick_wall_does_not_search_however_deep_the_tracker_is() -> None:
    thick = (slab("wall", (20.0, 0.0, 0.0), (40.0, 40.0, 40.0)),)
    records, _ = play(thick, limbed(), (-0.3, 0.0, 0.0), [(5.0, 0.0, 0.0)] * 90)
    assert total(records, "trapped") == total(records, "led") == 0


def test_a_jump_that_is_asked_for_is_not_made_to_a_posture_that_is_not_free() -> None:
    records, scene = play((*pocket(), STONE), limbed(), (-0.1, 0.0, 0.0), [BEYOND] * 90, search_work=0, walled_jump=20.0)
    assert total(records, "crossings") == 0 and records[-1].shown.positions[len(scene.bodies), 0] < 0.0


def seen(bodies: tuple[Body, ...], beyond: Vector = BEYOND) -> tuple[int, float]:
    """What holds a trunk at the origin off one that is beyond, and how far it is from there."""
    found = little(Scene("s", bodies, (limbed(),), start=at(rest((limbed(),)), (0.0, 0.0, 0.0))))
    geo, skel, posture, poses = found.parts
    way = make_way(geo, skel, posture, poses, found.memory, 0)
    memory = way.memory
    way.goal.root[0] = memory.goal.full[:3] = beyond
    forward(geo, skel, way.goal, memory.rows.x, memory.trial, memory.trial_axes)
    memory.goal.led[0] = 1.0
    held = what_holds_off(geo, skel, SETTINGS, poses, memory.goal, memory)
    return int(held), float(root_way(skel, memory.goal.full))



@pytest.mark.parametrize(
    ("bodies", "found"),
    [((TALL,), NOTHING), ((STONE,), BETWEEN), ((BLOCK,), INSIDE), ((PLATE,), BETWEEN), ((BLOCK, PLATE), BETWEEN)],
)
def test_what_stands_between_is_told_from_what_the_tracker_is_inside_of(bodies: tuple[Body, ...], found: int) -> None:
    held, to_go = seen(bodies)
    assert held == found
    assert to_go == pytest.approx(0.6, abs=1e-15)


@pytest.mark.parametrize(("gap", "found"), [(0.9 * FAR_OFF, INSIDE), (1.1 * FAR_OFF, NOTHING)])
def test_what_the_tracker_is_inside_of_holds_nobody_who_is_far_from_it(gap: float, found: int) -> None:
    thick = 2.0
    far = slab("far", (0.05 + gap + 0.5 * thick, 0.0, 0.0), (thick, 4.0, 4.0))
    beyond = (0.05 + gap + 0.5 * thick, 0.0, 0.0)
    assert seen((far,), beyond)[0] == found
    assert seen((far, PLATE), beyond)[0] == BETWEEN
