"""Straight arms are raised into a wall that they reach 18 cm beyond: as deep as each engine is known to leave them at its best.

At 1/60 neither is known to be of use for an avatar: 13 to 92 mm.
"""

import pytest

from avatarsim.engine import Engine
from tests.agreement.reached.driven import MM, led
from tests.agreement.reached.mannequin import AVATAR, before_wall, stretching
from tests.agreement.rivals import ENGINES

FRAMES, HELD = 75, slice(-15, None)
REACHED = {"mujoco": {240: (0.07, 0.0), 960: (0.05, 0.02)}, "pybullet": {240: (0.02, 0.0), 960: (0.01, 0.005)}}
"""Known depth at most and while held [mm], by steps per second; the finer one is known of 1/1020."""
LAST_DIGIT = 5e-3
"""Of a depth of 0 [mm]."""
COARSE: dict[str, dict[str, object]] = {
    "mujoco": {"integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1, "limit_steps": 0.1,
               "weld_time": 0.04},
    "pybullet": {},
}
"""What it takes at 1/240 with welds: MuJoCo's preset is for 1/960, and leaves 1.3 mm there. By motors: `test_motors.py`."""


def test_the_mannequin_has_sixteen_links_and_twenty_two_hinges() -> None:
    assert len(AVATAR.links) == 16 and AVATAR.hinge_count == 22


@ENGINES
@pytest.mark.parametrize("rate", [240, 960])
def test_arms_are_no_deeper_than_known(engine: Engine, rate: int) -> None:
    options: dict[str, object] = {"dt": 1.0 / rate}
    found = led(engine, before_wall(), stretching, FRAMES, options | (COARSE[engine.name] if rate == 240 else {}))
    most, held = REACHED[engine.name][rate]
    assert found.depths.max() <= most * MM
    assert found.depths[HELD].max() <= max(held, LAST_DIGIT) * MM
