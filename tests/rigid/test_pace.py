"""What counts as slow follows the gravity of the scene."""

import numpy as np
import pytest

from avatarsim.collision.conservative_advancement import TOUCH
from avatarsim.rigid.contacts import EARTH, pace_of
from avatarsim.rigid.impacts import REST_SPEED
from reference.closed_form import bounce_state
from tests.rigid.upper_world import G, World, ball, slab

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
