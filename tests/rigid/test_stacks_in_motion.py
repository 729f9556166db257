"""Stacks that move: the world goes on, nothing overlaps, no energy appears, and the budget is counted."""

import numpy as np
import pytest

from avatarsim.rigid.state import CONTACTS, DONE, OUT_OF_IMPACTS, OUT_OF_SEGMENTS, WORK
from avatarsim.scene.shape import Box
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
