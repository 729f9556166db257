"""MuJoCo led by motors in hinges: in a wall and at their limits as exact as they are known to be.

With one setting for all but two figures of 1/60.
"""

import pytest

from reference.in_mujoco.engine import MujocoEngine
from tests.agreement.reached.driven import MM, led
from tests.agreement.reached.mannequin import PAST, before_wall, stretching
from tests.agreement.reached.test_limits_of_joints import bending

HELD = slice(-15, None)
MOTORS: dict[str, object] = {
    "integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1, "limit_steps": 0.1, "weld_time": 0.04,
    "drive": "motors", "motor_stiffness": 400.0, "motor_damping_ratio": 1.0, "motor_force": 30.0, "armature": 4.0, "lead": 0.0,
}
"""Servos of 400 N m/rad and 30 N m, critically damped, with rotors of four times the inertia of the limb that they turn."""
DEPTHS = {240: (0.07, 0.0), 960: (0.05, 0.02)}
"""Known depth of arms in a wall, at most and while held [mm], by steps per second; the finer one is known of 1/1020."""
LAST_DIGIT = 5e-3
"""Of a depth of 0 [mm]."""
IN_WALL = {60: 0.33, 240: 0.001, 960: 0.0005}
"""Known excess over limits at most while a wall pushes [deg]."""
QUICK: dict[str, object] = {"motor_force": 150.0, "armature": 0.3}
"""What that takes at 1/60 from the first frame on: with 30 N m limbs are thrown 51 degrees beyond before they are held."""
UNCUT = {60: (1.4, 0.02), 240: (0.010, 0.001), 960: (0.0005, 0.0005)}
"""Known excess at most and while held [deg], with targets 30 degrees past the limits."""
UNBOUND: dict[str, object] = {"motor_force": 0.0, "armature": 0.3}
"""What that takes at 1/60: a servo that is at its most has no damping, and its limb is thrown 26 degrees beyond."""


@pytest.mark.parametrize("rate", DEPTHS)
def test_arms_in_a_wall_are_no_deeper_than_known(rate: int) -> None:
    found = led(MujocoEngine(), before_wall(), stretching, 75, {"dt": 1.0 / rate, **MOTORS})
    most, held = DEPTHS[rate]
    assert found.depths.max() <= most * MM
    assert found.depths[HELD].max() <= max(held, LAST_DIGIT) * MM


@pytest.mark.parametrize("rate", IN_WALL)
def test_a_wall_that_pushes_bends_no_joint_further_than_known(rate: int) -> None:
    options = {"dt": 1.0 / rate, **MOTORS, **(QUICK if rate == 60 else {})}
    found = led(MujocoEngine(), before_wall(), lambda frame: stretching(frame, PAST), 75, options)
    assert found.excess.max() <= IN_WALL[rate]


@pytest.mark.parametrize("rate", UNCUT)
def test_a_servo_asked_too_much_is_held_as_well_as_known(rate: int) -> None:
    options = {"dt": 1.0 / rate, "clamp_targets": False, **MOTORS, **(UNBOUND if rate == 60 else {})}
    found = led(MujocoEngine(), before_wall(False), bending, 60, options)
    most, held = UNCUT[rate]
    assert found.excess.max() <= most
    assert found.excess[HELD].max() <= held
