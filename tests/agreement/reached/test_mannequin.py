"""Straight arms raised into a wall that they reach 18 cm beyond, and elbows and wrists asked to go 30 degrees past their limits:
as deep, and as far beyond, as each engine is known to be at its best.

At 1/60 neither is known to be of use in a wall: 13 to 92 mm. Known figures of 960 steps per second are of 1/1020; a known 0 is
known to its last digit.
"""

from typing import NamedTuple

import pytest

from tests.agreement.reached.driven import led
from tests.agreement.reached.mannequin import AVATAR, HANGS, PAST, before_wall, posed, stretching
from tests.agreement.rivals import RIVALS
from tests.agreement.runs import FRAME, MM

Options = dict[str, object]
LAST = slice(-15, None)
DEPTH_DIGIT, EXCESS_DIGIT = 5e-3, 5e-4
"""Half of the last digit of a depth [mm] and of an excess [deg]."""
COARSE: Options = {"integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1, "limit_steps": 0.1,
                   "weld_time": 0.04}
"""Settings of MuJoCo's welds at 1/240: its preset is for 1/960, and leaves 1.3 mm there."""
MOTORS: Options = {
    **COARSE, "drive": "motors", "motor_stiffness": 400.0, "motor_damping_ratio": 1.0, "motor_force": 30.0, "armature": 4.0,
    "lead": 0.0,
}
"""Servos of 400 N m/rad and 30 N m, critically damped, with rotors of four times the inertia of the limb that they turn."""
QUICK: Options = {**MOTORS, "motor_force": 150.0, "armature": 0.3}
"""At 1/60 from the first frame on: with 30 N m limbs are thrown 51 degrees beyond before they are held."""
UNCUT: Options = {**MOTORS, "clamp_targets": False}
UNBOUND: Options = {**UNCUT, "motor_force": 0.0, "armature": 0.3}
"""At 1/60: a servo at its largest torque has no damping, and its limb is thrown 26 degrees beyond."""
UNHURRIED: Options = {"feed_forward": False}
"""PyBullet's joints arrive at their limits as fast as their user, if they are given the speed, and are beyond for a step; given
positions alone, as the figure is known, they slow down before."""


class Known(NamedTuple):
    """Steps per second, and the known figure at most and in the last quarter of a second; None where it is not known."""

    engine: str
    rate: int
    most: float | None
    last: float | None
    options: Options


DEPTHS = [
    Known("mujoco", 240, 0.07, 0.0, COARSE), Known("mujoco", 960, 0.05, 0.02, {}),
    Known("mujoco", 240, 0.07, 0.0, MOTORS), Known("mujoco", 960, 0.05, 0.02, MOTORS),
    Known("pybullet", 240, 0.02, 0.0, {}), Known("pybullet", 960, 0.01, 0.005, {}),
]
"""Of straight arms in the wall [mm]."""
FREE = [
    Known("mujoco", 60, 1.4, 0.02, {}), Known("mujoco", 240, 0.010, 0.001, {}), Known("mujoco", 960, 0.0, 0.0, {}),
    Known("mujoco", 60, 1.4, 0.02, UNBOUND), Known("mujoco", 240, 0.010, 0.001, UNCUT), Known("mujoco", 960, 0.0, 0.0, UNCUT),
    Known("pybullet", 60, 0.15, 0.15, UNHURRIED), Known("pybullet", 240, 0.002, 0.0, UNHURRIED),
    Known("pybullet", 960, 0.0, 0.0, UNHURRIED),
    Known("pybullet", 60, None, 0.15, {}), Known("pybullet", 240, None, 0.0, {}), Known("pybullet", 960, None, 0.0, {}),
]
"""Excess over limits of hanging arms [deg]. MuJoCo's targets are cut at the limit, as in its preset, but where they are UNCUT:
welds that are asked past it pull a limb 0.01 degrees beyond at 1/960."""
PRESSED = [
    Known("mujoco", 60, 0.33, None, QUICK), Known("mujoco", 240, 0.001, None, MOTORS), Known("mujoco", 960, 0.0, None, MOTORS),
    Known("pybullet", 60, None, 13.0, {}), Known("pybullet", 240, None, 0.28, {}), Known("pybullet", 960, None, 0.002, {}),
]
"""Excess over limits of arms that a wall pushes [deg]."""


def table(rows: list[Known]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("known", rows, ids=lambda known: f"{known.engine}-{known.rate}-{'-'.join(known.options)}")


def checked(known: Known, wall: bool, past: float, depth: bool) -> None:
    """Fail where an engine does not reach its known figure; skip where it is not installed."""
    engines = [engine for engine in RIVALS if engine.name == known.engine]
    if not engines:
        pytest.skip(f"{known.engine} is not installed")
    options = {"dt": 1.0 / known.rate, **known.options}
    if wall:
        found = led(engines[0], before_wall(), lambda frame: stretching(frame, past), 75, options)
    else:
        found = led(engines[0], before_wall(False),
                    lambda frame: posed(FRAME * frame, HANGS, past * min(1.0, FRAME * frame / 0.3)), 60, options)
    figures, unit, digit = (found.depths, MM, DEPTH_DIGIT) if depth else (found.excess, 1.0, EXCESS_DIGIT)
    if known.most is not None:
        assert figures.max() <= max(known.most, digit) * unit
    if known.last is not None:
        assert figures[LAST].max() <= max(known.last, digit) * unit


def test_the_mannequin_has_sixteen_links_and_twenty_two_hinges() -> None:
    assert len(AVATAR.links) == 16 and AVATAR.hinge_count == 22


@table(DEPTHS)
def test_arms_in_a_wall_are_no_deeper_than_known(known: Known) -> None:
    checked(known, wall=True, past=0.0, depth=True)


@table(FREE)
def test_joints_are_no_further_beyond_their_limits_than_known(known: Known) -> None:
    checked(known, wall=False, past=PAST, depth=False)


@table(PRESSED)
def test_a_wall_that_pushes_bends_no_joint_further_than_known(known: Known) -> None:
    checked(known, wall=True, past=PAST, depth=False)
