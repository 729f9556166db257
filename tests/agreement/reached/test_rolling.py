"""A sliding ball finally rolls at 5/7 of its speed; the speed lost in an oblique bounce follows Coulomb's law."""

import numpy as np
import pytest

from avatarsim.engine import Engine
from avatarsim.scene.body import ContactLaw
from tests.agreement.reached.bodies import BALL, BALL_MASS, GRAVITY, Thrown, over_floor, seen
from tests.agreement.rivals import STUDIED

SPEED, FRICTION = 2.0, 0.2
"""First speed [m/s] and coefficient of friction of the ball that slides."""
ROLLS_FROM = 2.0 * SPEED / (7.0 * FRICTION * GRAVITY)
"""Time [s] at which sliding ends."""
SHARE = 5.0 / 7.0
ROLLS_AT = {
    "mujoco": {60: 0.71163, 240: 0.71314, 1000: 0.71418},
    "pybullet": {60: 0.71429, 240: 0.71429, 1000: 0.71429},
}
"""Known remaining share of the first speed, by steps per second."""
LAST_DIGIT = 5e-6
TOUCHES = 1e-9
"""Initial depth [m] of the ball: it is in contact from the first step on.
A ball that only touches sinks for one step before its contact is found, which at 1/60 is as large as the table's error."""
STRIKES = (2.0, 4.0)
"""Velocity [m/s] along and down of the ball that bounces, from 5 cm above the floor."""
OBLIQUE = ContactLaw(0.3, 0.1)
LOST_TOO_MUCH = 0.006
"""Known error [m/s] of the speed along the floor that the oblique bounce at 1/240 loses; the exact loss is 0.536."""
BOUNCED = 0.304
"""Known restitution of that bounce; the exact one is 0.3."""


@STUDIED
@pytest.mark.parametrize("rate", [60, 240, 1000])
@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_sliding_ball_rolls_in_time_at_five_sevenths(
    engine: Engine, rate: int, restitution: float
) -> None:
    ball = Thrown(BALL, BALL_MASS, (0.0, 0.0, BALL.radius - TOUCHES), (SPEED, 0.0, 0.0), ContactLaw(restitution, FRICTION))
    found = seen(engine, over_floor("slide_to_roll", [ball]), rate, 0.6)
    error = abs(found.velocities[-1, 0, 0] / SPEED - SHARE)
    assert error <= abs(ROLLS_AT[engine.name][rate] - SHARE) + 2.0 * LAST_DIGIT
    # MuJoCo's friction of balls that cannot bounce is softer: the rest of the slip dies out in 20 steps
    if restitution == (0.3 if engine.name == "mujoco" else 0.0):
        slip = found.velocities[:, 0, 0] - BALL.radius * found.spins[:, 0, 1]
        # the rest is less than friction removes in half a step
        ends = int(np.argmax(slip < 0.5 * 3.5 * FRICTION * GRAVITY / rate)) / rate
        assert ends == pytest.approx(ROLLS_FROM, abs=1.0 / rate)


@STUDIED
def test_an_oblique_bounce_loses_what_coulomb_says(engine: Engine) -> None:
    """At eight phases of the step, from the speed at which the ball was found on the floor."""
    along, down = STRIKES
    balls = [Thrown(BALL, BALL_MASS, (0.0, float(k), BALL.radius + 0.05 + down / 240.0 * k / 8.0), (along, 0.0, -down), OBLIQUE)
             for k in range(8)]
    found = seen(engine, over_floor("oblique_bounce", balls), 240, 0.06)
    for k in range(8):
        speed = found.velocities[:, k]
        up = int(np.argmax(speed[:, 2] > 0.0))
        arrived, lost = -speed[up - 1, 2], along - speed[up, 0]
        assert abs(lost - OBLIQUE.friction * (1.0 + OBLIQUE.restitution) * arrived) <= LOST_TOO_MUCH
        assert abs(speed[up, 2] / arrived - OBLIQUE.restitution) <= BOUNCED - OBLIQUE.restitution
