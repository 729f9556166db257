"""Eq. 8: v+ = -e v-, at the event, for every restitution and frame time."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.rigid.contact_law import velocity_after
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import G, World, ball, slab, thing

RATES = (30.0, 60.0, 240.0, 1000.0)


def test_the_law_itself() -> None:
    """Separating is positive."""
    assert velocity_after(0.25, -8.0) == 2.0


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
def test_a_dropped_ball_rebounds_as_stated(restitution: float, rate: float) -> None:
    """From 1 m: v+/v- within 1e-9, time of impact and first apex e^2 h within 1e-6 m."""
    world = World([slab(), ball("ball", (0.0, 0.0, 1.1))], restitution)
    apex = 0.0
    while len(world.impacts) < 2 and world.time < 0.46 + 2.0 * restitution * np.sqrt(2.0 / G) + 2.0 / rate:
        assert world.frame(1.0 / rate) == 0
        if len(world.impacts) == 1:
            # the height that this state still climbs to
            z, v = world.poses.position[1, 2], world.velocities.linear[1, 2]
            apex = z - 0.1 + max(v, 0.0) * abs(v) / (2.0 * G) if v >= 0.0 else apex
    time, _, before, _, after, _ = world.impacts[0]
    assert after[1, 2] / before[1, 2] == pytest.approx(-restitution, abs=1e-9)
    assert time == pytest.approx(np.sqrt(2.0 / G), abs=1e-8)
    assert apex == pytest.approx(restitution**2, abs=1e-6)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 1.0])
def test_a_box_that_lands_flat_rebounds_without_spin(restitution: float) -> None:
    """The four corners are one block of impulses: one after the other they would set it spinning."""
    world = World([slab(), thing("box", Box((0.4, 0.2, 0.1)), (0.3, 0.2, 0.55))], restitution, 0.5)
    world.run(0.4)
    _, _, before, _, after, spin = world.impacts[0]
    assert after[1, 2] / before[1, 2] == pytest.approx(-restitution, abs=1e-9)
    assert np.abs(spin[1]).max() < 1e-9


def test_a_corner_is_hit_symmetrically() -> None:
    """Two walls reached at the same instant at the same speed: both normal velocities are reversed."""
    walls = slab((1.0, 4.0, 4.0), position=(-0.5, 0.0, 0.0)), slab((4.0, 1.0, 4.0), position=(0.0, -0.5, 0.0))
    flier = ball("ball", (0.2, 0.2, 0.0), velocity=(-1.0, -1.0, 0.0))
    world = World([walls[0], replace(walls[1], name="other"), flier], 0.5, gravity=(0.0, 0.0, 0.0))
    world.run(0.3)
    assert len(world.impacts) == 1
    np.testing.assert_allclose(world.velocities.linear[2], [0.5, 0.5, 0.0], atol=1e-9)
