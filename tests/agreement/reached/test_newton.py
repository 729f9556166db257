"""Restitution that each engine is known to reach, at four steps and eight phases within a step; our adapters reach it too.

Across the step of an impact MuJoCo's one-step damper gives v+/v- to four decimals, and so does PyBullet without position
correction in its velocities. Measured at the surface both have an error due to the rest of the step after the impact: a ball that
is found at depth v dt returns from there. That part is the same for every engine of fixed steps.
"""

from functools import cache
from math import sqrt

import numpy as np
import pytest

from avatarsim.engine import Engine
from avatarsim.scene.body import ContactLaw
from reference.in_mujoco.engine import MujocoEngine
from tests.agreement.reached.bodies import BALL, BALL_MASS, GRAVITY, RATES, Seen, Thrown, over_floor, seen
from tests.agreement.rivals import STUDIED, PybulletEngine

ASKED = (0.1, 0.2, 0.3, 0.5, 0.8, 1.0)
"""Restitution of the balls."""
PHASES, HEIGHT = 8, 1.0
"""Balls of each restitution, dropped from one metre and a little more, so that they arrive at eight phases of a step."""
FOUR_DECIMALS = 5e-5
EXACT: dict[str, dict[str, object]] = {"mujoco": {"kappa": 0.0}, "pybullet": {}}
"""Without the position correction that the preset needs for stacks."""
KAPPA = 0.002
"""Restitution that the position correction of the preset may add."""
AT_SURFACE = {
    240: (0.100, 0.034, 0.017, 0.009, 0.009, 0.009),
    1000: (0.022, 0.008, 0.004, 0.002, 0.002, 0.002),
    4000: (0.005, 0.002, 0.001, 0.001, 0.001, 0.001),
}
"""Largest error of MuJoCo's restitution measured at the surface, to three decimals, by steps per second."""
HALF_A_DIGIT = 5e-4


@cache
def dropped(name: str, rate: int, exact: bool = True) -> Seen:
    """Return the states of PHASES balls of each restitution until all have bounced."""
    engine: Engine = MujocoEngine() if name == "mujoco" else PybulletEngine()
    arrives = sqrt(2.0 * GRAVITY * HEIGHT)
    balls = [
        Thrown(BALL, BALL_MASS, (float(k), float(phase), BALL.radius + HEIGHT + arrives / rate * phase / PHASES), (0.0, 0.0, 0.0),
               ContactLaw(e, 0.0))
        for k, e in enumerate(ASKED) for phase in range(PHASES)
    ]
    return seen(engine, over_floor("drops", balls), rate, 0.55, **(EXACT[name] if exact else {}))


def across_the_step(ball: int, found: Seen) -> tuple[int, float]:
    """Return the first state in which a ball rises, and v+/v- across the step before it."""
    speed = found.velocities[:, ball, 2]
    k = int(np.argmax(speed > 0.0))
    return k, float(speed[k] / -speed[k - 1])


def at_surface(ball: int, found: Seen) -> float:
    """Return sqrt of the energy ratio of the first rising state above the floor to the last falling one; 0 without one."""
    height, speed = found.places[:, ball, 2] - BALL.radius, found.velocities[:, ball, 2]
    k = int(np.argmax(speed > 0.0))
    out = np.flatnonzero((speed[k:] > 0.0) & (height[k:] >= 0.0))
    if not len(out):
        return 0.0
    energy = speed**2 + 2.0 * GRAVITY * height
    return sqrt(energy[k + out[0]] / energy[k - 1])


@STUDIED
@pytest.mark.parametrize("rate", RATES)
def test_velocities_across_the_step_of_an_impact_are_exact(engine: Engine, rate: int) -> None:
    found = dropped(engine.name, rate)
    for ball in range(len(ASKED) * PHASES):
        assert across_the_step(ball, found)[1] == pytest.approx(ASKED[ball // PHASES], abs=FOUR_DECIMALS)


@pytest.mark.parametrize("rate", RATES)
def test_the_preset_adds_no_more_than_its_position_correction(rate: int) -> None:
    found = dropped("mujoco", rate, exact=False)
    for ball in range(len(ASKED) * PHASES):
        assert -FOUR_DECIMALS < across_the_step(ball, found)[1] - ASKED[ball // PHASES] < KAPPA + FOUR_DECIMALS


@STUDIED
@pytest.mark.parametrize("rate", AT_SURFACE)
def test_at_the_surface_errors_are_those_of_the_step(engine: Engine, rate: int) -> None:
    """The table is MuJoCo's; PyBullet is as good except for its rise within the step of the impact."""
    found, more = dropped(engine.name, rate), 0.0 if engine.name == "mujoco" else 2e-3
    for k, asked in enumerate(ASKED):
        worst = max(abs(at_surface(PHASES * k + phase, found) - asked) for phase in range(PHASES))
        assert worst < AT_SURFACE[rate][k] + HALF_A_DIGIT + more
