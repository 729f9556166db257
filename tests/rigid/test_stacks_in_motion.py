"""Stacks that move, and bodies that begin in each other: no overlap stays, no energy appears, the budget is counted."""

import numpy as np
import pytest

from avatarsim.rigid.state import CONTACTS, DONE, OUT_OF_IMPACTS, OUT_OF_SEGMENTS, SQUEEZED, UNSQUEEZED, WORK
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, Piece
from tests.rigid.upper_world import G, World, ball, slab, thing


def tower(boxes: int, lift: float) -> list:
    """Boxes of 0.2 m, one on the other, the lowest ``lift`` above the slab."""
    return [thing(f"box_{k}", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + lift + k * (0.2 + 2e-8))) for k in range(boxes)]


def test_a_struck_tower_comes_down() -> None:
    """A ball at 6 m/s: two seconds of impacts, slipping edges and landings; where it halted, bodies had speed and stayed."""
    world = World([slab(), *tower(5, 2e-8), ball("ball", (-0.8, 0.02, 0.5), mass=4.0, velocity=(6.0, 0.0, 0.0))], 0.3, 0.4)
    energy = world.energy()
    for _ in range(120):
        before, fast = world.poses.position.copy(), np.linalg.norm(world.velocities.linear, axis=1) > 0.01
        world.frame()
        still = np.linalg.norm(world.poses.position - before, axis=1) < 1e-9
        assert not (fast & still & (np.linalg.norm(world.velocities.linear, axis=1) > 0.01)).any()
        assert world.energy() <= energy + 1e-9
        energy = world.energy()
        assert world.gap() >= -1e-6
        assert world.memory.counts[WORK] < 400000
    assert world.poses.position[5, 2] < 0.5


@pytest.mark.parametrize("lift", [0.001, 0.01])
def test_a_dropped_tower_rests(lift: float) -> None:
    """Five boxes fall by a millimetre or a centimetre and lie still within two seconds."""
    world = World([slab(), *tower(5, lift)], 0.3, 0.5)
    for _ in range(120):
        world.frame()
        assert world.gap() >= -1e-6
    assert not world.velocities.linear.any() and not world.velocities.angular.any()


def test_a_wall_that_lands_keeps_its_budget() -> None:
    """Sixteen rows of bricks, each a centimetre above the one below: a thousand contacts at once, for which no frame has time."""
    bricks = [
        thing(f"brick_{row}_{k}", Box((0.2, 0.1, 0.1)), (0.202 * (k + 0.5 * row), 0.0, 0.11 * (row + 1) - 0.05), 2.0)
        for row in range(16) for k in range(16 - row)
    ]
    world = World([slab(), *bricks], 0.3, 0.5)
    energy, least, most, contacts = world.energy(), 0.0, 0, 0
    for k in range(24):
        status = world.frame(record=False, sleeping=False)
        assert status in (DONE, OUT_OF_SEGMENTS, OUT_OF_IMPACTS)
        assert world.energy() <= energy + 1e-6 * abs(energy)
        energy, most = world.energy(), max(most, int(world.memory.counts[WORK]))
        contacts = max(contacts, int(world.memory.counts[CONTACTS]))
        least = min(least, world.gap()) if k % 6 == 5 else least
    assert contacts > 1000
    # without a budget of visits it took four millions
    assert most < 700000
    assert least >= -1e-6


@pytest.mark.parametrize("ratio", [1.0, 10.0, 1e2, 1e3, 1e4])
@pytest.mark.parametrize("boxes", [1, 3])
def test_a_heavy_box_stands_on_light_ones(ratio: float, boxes: int) -> None:
    """Each begins a millimetre above the one below. At 1e5 to 1 it takes ten seconds to rest; from a million to one on the budget
    of impacts of every frame is spent on rebounds between floor and heavy box, and the light one hangs in the air."""
    tall = [thing(f"box_{k}", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.2 * k + 1e-3 * (k + 1)), 1.0) for k in range(boxes)]
    heavy = thing("heavy", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.2 * boxes + 1e-3 * (boxes + 1)), ratio)
    world = World([slab(), *tall, heavy], 0.0, 0.5)
    energy = world.energy()
    for _ in range(300):
        world.frame()
        # contacts that have dipped open by less than a micrometre
        assert world.energy() <= energy + 1e-6 * G * (boxes + ratio)
        energy = world.energy()
        assert world.gap() >= -1e-6
    assert not world.velocities.linear.any() and not world.velocities.angular.any()
    heights = [0.1 + 0.2 * k for k in range(boxes + 1)]
    np.testing.assert_allclose(world.poses.position[1:, 2], heights, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(world.poses.position[1:, :2], 0.0, rtol=0.0, atol=1e-4)


DEEP = 3e-6
"""By so much [m] the lowest box begins in the floor, and each in the one below: three times what may be shown."""


def pressed(boxes: int, ratio: float) -> World:
    """Boxes of 1 kg on one another, and one of ``ratio`` kg on them, all in each other."""
    edges = Box((0.2, 0.2, 0.2))
    masses = [1.0] * boxes + [ratio]
    things = [thing(f"box_{k}", edges, (0.0, 0.0, 0.1 + 0.2 * k - DEEP * (k + 1)), m) for k, m in enumerate(masses)]
    return World([slab(), *things], 0.0, 0.5)


@pytest.mark.parametrize("boxes", [1, 3])
@pytest.mark.parametrize("ratio", [1.0, 1e2, 1e3, 1e4, 1e6])
def test_what_is_held_down_by_a_ton_rises_too(boxes: int, ratio: float) -> None:
    """By mass alone the lowest box would rise into the one above and come down into the floor again, for ever."""
    world = pressed(boxes, ratio)
    status = world.frame()
    assert world.memory.counts[UNSQUEEZED] == 1
    assert status != SQUEEZED
    assert world.gap() >= -7e-7


def test_who_is_light_gives_way_first() -> None:
    """A ball in a heavy one: where mass alone is enough it decides, and the centre of mass stays."""
    heavy, light = ball("heavy", (0.0, 0.0, 0.0), mass=1e3), ball("light", (0.0, 0.0, 0.2 - 2.0 * DEEP))
    world = World([heavy, light], gravity=(0.0, 0.0, 0.0))
    assert world.frame() == DONE
    rise = world.poses.position[1, 2] - (0.2 - 2.0 * DEEP)
    assert rise == pytest.approx(2.0 * DEEP + 2e-8, rel=2e-3)
    assert 1e3 * world.poses.position[0, 2] + rise == pytest.approx(0.0, abs=1e-12)
    assert not world.velocities.linear.any()


def test_a_ball_in_a_slot_too_narrow_for_it_is_squeezed() -> None:
    """No place for it is free, and the frame's status is that, whatever else happens in it."""
    lid = fixed("lid", (Piece(Box((4.0, 4.0, 1.0))),), "m", (0.0, 0.0, 0.7 - 2.0 * DEEP))
    others = [thing(f"box_{k}", Box((0.1, 0.1, 0.1)), (3.0 + k, 0.0, 0.5), angular_velocity=(3.0, 2.0, 1.0)) for k in range(3)]
    world = World([slab(), lid, ball("ball", (0.0, 0.0, 0.1 - DEEP)), *others], 0.3, 0.5)
    assert [world.frame(sleeping=False) for _ in range(30)] == [SQUEEZED] * 30
