"""Stacks that move: the world goes on, nothing overlaps, no energy appears, and the budget is counted."""

import numpy as np
import pytest

from avatarsim.loops.upper_memory import PLASTIC, WORK
from avatarsim.scene.shape import Box
from tests.loops.upper_world import World, ball, slab, thing


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
    assert world.memory.counts[PLASTIC] == 0
