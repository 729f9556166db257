"""Impacts: random ones add no energy, those of driven bodies obey equation 9, and slow is what the scene's gravity makes slow."""

import numpy as np
import pytest

from avatarsim.collision.conservative_advancement import TOUCH
from avatarsim.rigid.contacts import EARTH, pace_of
from avatarsim.rigid.impacts import REST_SPEED
from avatarsim.rigid.resting import SOLVED
from avatarsim.scene.shape import Box
from reference.closed_form import bounce_state
from tests.rigid.random_impacts import ROUNDING, run
from tests.rigid.upper_world import G, World, ball, hand, slab, thing


def test_no_impact_adds_energy_or_loses_momentum() -> None:
    (impacts, guarded, rough), worst = run(50_000, seed=5)
    # Newton's law with friction would have added energy in some, and is shortened there
    assert impacts >= 50_000 and guarded > 0.001 * impacts and rough > 0.5 * impacts
    assert np.isfinite(worst).all() and (worst <= ROUNDING).all() and worst.min() > 0.0


NO_GRAVITY = (0.0, 0.0, 0.0)
FRAME = 1.0 / 60.0
ON_HAND = 0.05 + 2e-8
"""Height of the underside of what lies on a hand."""


@pytest.mark.parametrize("mass", [0.1, 2.0, 100.0, 1e6])
def test_a_hand_that_meets_a_body_gets_the_impulse_of_eq_9_and_no_more(mass: float) -> None:
    """The hand of 2 kg moves up at 1.5 m/s: j = (1 + e) v / (1/m + 1/M) to both, whatever M."""
    world = World([thing("box", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + ON_HAND), mass)], 0.5, 0.0, NO_GRAVITY, [hand()])
    world.velocities.linear[1] = (0.0, 0.0, 1.5)
    assert world.frame() == 0
    j = 1.5 * 1.5 / (1.0 / 2.0 + 1.0 / mass)
    np.testing.assert_allclose(world.memory.received[1], [0.0, 0.0, -j], rtol=1e-9, atol=SOLVED * mass + 1e-9)
    np.testing.assert_allclose(world.velocities.linear[0], [0.0, 0.0, j / mass], rtol=1e-6, atol=SOLVED)


@pytest.mark.parametrize("mass", [100.0, 1e6])
def test_a_heavy_body_that_throws_a_hand_back_waits_at_it_and_keeps_its_velocity(mass: float) -> None:
    """The hand's pose changes in the next frame. Until then nothing overlaps, and the hand gets what eq. 9 gives."""
    box = thing("box", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.06), mass, velocity=(0.3, 0.0, -1.0))
    world = World([box], 0.5, 0.0, NO_GRAVITY, [hand()])
    assert world.frame() == 0
    j = 1.5 * 1.0 / (1.0 / 2.0 + 1.0 / mass)
    np.testing.assert_allclose(world.memory.received[1], [0.0, 0.0, -j], rtol=1e-9, atol=SOLVED * mass)
    np.testing.assert_allclose(world.velocities.linear[0], [0.3, 0.0, -1.0 + j / mass], rtol=1e-6)
    assert world.gap() > 0.0
    # along the hand it goes on
    assert world.poses.position[0, 0] == pytest.approx(0.3 * FRAME, rel=1e-6)


@pytest.mark.parametrize("mass", [3.0, 4.0, 1e4])
def test_a_weight_gives_a_hand_twice_its_own_mass_at_most(mass: float) -> None:
    """Resting: M g dt as long as M < 2 m; beyond, 2 m g dt, and the body keeps the rest of its fall."""
    world = World([thing("box", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + ON_HAND), mass)], 0.0, 0.0, avatars=[hand()])
    assert world.frame(sleeping=False) == 0
    carried = min(mass, 4.0)
    np.testing.assert_allclose(world.memory.received[1], [0.0, 0.0, -carried * G * FRAME], rtol=1e-6)
    assert world.velocities.linear[0, 2] == pytest.approx(-(1.0 - carried / mass) * G * FRAME, abs=1e-6)
    assert world.gap() > -3e-7


def test_momentum_is_kept_between_a_hand_and_what_waits() -> None:
    """Over a flight, an impact and a wait: what the body lost the hand received."""
    box = thing("box", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.055), 50.0, velocity=(0.0, 0.0, -2.0))
    world = World([box, slab(position=(0.0, 0.0, -5.0))], 0.3, 0.2, NO_GRAVITY, [hand()])
    before = world.velocities.linear[0].copy()
    assert world.frame() == 0
    np.testing.assert_allclose(50.0 * (world.velocities.linear[0] - before), -world.memory.received[2], rtol=1e-9, atol=1e-12)


def test_a_hand_that_recedes_carries_nothing() -> None:
    """The ball falls after it: the hand gets no weight, the ball its g dt."""
    world = World([ball("ball", (0.0, 0.0, 0.1 + ON_HAND))], 0.0, 0.0, avatars=[hand()])
    world.velocities.linear[1] = (0.0, 0.0, -5.0)
    assert world.frame(sleeping=False) == 0
    np.testing.assert_allclose(world.memory.received[1], 0.0, atol=1e-12)
    assert world.velocities.linear[0, 2] == pytest.approx(-G * FRAME, rel=1e-6)
    assert world.gap() > -3e-7


RESTS = 1.15e-7
"""Height [m] to which a ball rises with REST_SPEED on Earth."""


@pytest.mark.parametrize("gravity", [0.0, EARTH, G, 1e3 * G])
def test_on_earth_without_gravity_and_under_more_of_it_speeds_are_as_stated(gravity: float) -> None:
    assert pace_of(np.array([0.0, 0.0, -gravity])) == 1.0


@pytest.mark.parametrize("gravity", [1.62, 9.81e-3, 1e-6])
def test_under_less_gravity_a_ball_at_rest_speed_rises_no_higher(gravity: float) -> None:
    speed = pace_of(np.array([0.0, gravity, 0.0])) * REST_SPEED
    assert speed * speed / (2.0 * gravity) == pytest.approx(RESTS, rel=0.01)


@pytest.mark.parametrize("dt", [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0])
@pytest.mark.parametrize("scale", [1.0, 1e-1, 1e-2, 1e-3])
def test_a_ball_bounces_alike_in_any_unit(scale: float, dt: float) -> None:
    """Lengths and gravity in another unit, times as they are: only at its last bounces, of a micrometre, it is off by as much.

    A body that is nearer than TOUCH when a frame begins has met.
    """
    radius, height, restitution = 0.1 * scale, 0.5 * scale, 0.5
    world = World(
        [slab(size=(40.0 * scale, 40.0 * scale, scale)), ball("b", (0.0, 0.0, radius + height), radius=radius)],
        restitution=restitution, gravity=(0.0, 0.0, -scale * G),
    )
    while world.time < 1.2:
        assert world.frame(dt) == 0
        expected = radius + scale * bounce_state(0.5, restitution, G, world.time)[0]
        assert world.poses.position[1, 2] == pytest.approx(expected, abs=TOUCH)
