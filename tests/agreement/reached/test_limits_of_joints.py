"""Elbows and wrists are asked to go 30 degrees past their limits: as far beyond as each engine is known to let them go at best.

What MuJoCo is asked for is cut at the limit, as in its preset: asked past it, welds pull a limb 0.01 degrees beyond at 1/960.
Servos that are asked for all of it are in `test_motors.py`.
"""

import pytest

from avatarsim.engine import Engine
from avatarsim.scene.tracker import TrackerSample
from tests.agreement.reached.driven import FRAME, led
from tests.agreement.reached.mannequin import HANGS, PAST, before_wall, posed, stretching
from tests.agreement.rivals import ENGINES, PybulletEngine, needs_pybullet

FRAMES, HELD = 60, slice(-15, None)
REACHED = {
    "mujoco": {60: (1.4, 0.02), 240: (0.010, 0.001), 960: (0.0005, 0.0005)},
    "pybullet": {60: (0.15, 0.15), 240: (0.002, 0.0005), 960: (0.0005, 0.0005)},
}
"""Known excess at most and while held [deg], by steps per second; 0.000 is known to its last digit, and of 1/1020."""
UNHURRIED: dict[str, dict[str, object]] = {"mujoco": {}, "pybullet": {"feed_forward": False}}
"""PyBullet's joints arrive at their limits as fast as their user went, if they are told how fast, and are beyond for a step; told
where to be alone, as that figure is known, they slow down before."""
HURRIED = {60: 0.15, 240: 0.0005, 960: 0.0005}
"""Known excess while held [deg], which the preset reaches as well."""
IN_WALL = {60: 13.0, 240: 0.28, 960: 0.002}
"""Known excess in PyBullet while arms are pressed against a wall [deg]."""


def bending(frame: int) -> TrackerSample:
    """Within 0.3 s, arms hanging."""
    return posed(FRAME * frame, HANGS, PAST * min(1.0, FRAME * frame / 0.3))


@ENGINES
@pytest.mark.parametrize("rate", [60, 240, 960])
def test_joints_are_no_further_beyond_than_known(engine: Engine, rate: int) -> None:
    found = led(engine, before_wall(False), bending, FRAMES, {"dt": 1.0 / rate, **UNHURRIED[engine.name]})
    most, held = REACHED[engine.name][rate]
    assert found.excess.max() <= most
    assert found.excess[HELD].max() <= held


@needs_pybullet
@pytest.mark.parametrize("rate", [60, 240, 960])
def test_pybullet_s_preset_holds_them_as_well_once_they_are_there(rate: int) -> None:
    found = led(PybulletEngine(), before_wall(False), bending, FRAMES, {"dt": 1.0 / rate})
    assert found.excess[HELD].max() <= HURRIED[rate]


@needs_pybullet
@pytest.mark.parametrize("rate", [60, 240, 960])
def test_pybullet_holds_them_against_a_wall(rate: int) -> None:
    found = led(PybulletEngine(), before_wall(), lambda frame: stretching(frame, PAST), 75, {"dt": 1.0 / rate})
    assert found.excess[HELD].max() <= IN_WALL[rate]
