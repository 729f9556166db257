"""Position projection: bodies that overlap are moved apart, whatever they weigh; a state that is left overlapping says so."""

import pytest

from avatarsim.rigid.state import DONE, SQUEEZED, UNSQUEEZED
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, Piece
from tests.rigid.upper_world import World, ball, slab, thing

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
