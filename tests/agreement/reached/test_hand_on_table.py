"""A hand of fifteen ellipsoids is pressed 10 cm into a table and drawn along it: as deep as each engine is known to be."""

import numpy as np
import pytest

from avatarsim.engine import Engine
from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from tests.agreement.reached.driven import FRAME, MM, led
from tests.agreement.rivals import ENGINES

THICK, RESTS, HIGH, DEEP = 0.06, 0.014, 0.1, 0.1
"""Of the table [m]; height of the palm's centre that touches it about, first height above that, and depth below it [m]."""
FRAMES, PRESSED = 60, slice(15, None)
"""The hand meets the table after a quarter of a second."""
REACHED = {
    "mujoco": {60: (8.5, 0.18), 240: (1.6, 0.08), 1000: (0.17, 0.0)},
    "pybullet": {60: (0.69, 0.009), 240: (0.02, 0.009), 1000: (0.01, 0.009)},
}
"""Known depth at most, and its median while pressed [mm], by steps per second: the best of each column of the settings that stay
on their side of the table."""
COARSE: dict[str, dict[str, object]] = {
    "mujoco": {
        "integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1, "lead": 0.0, "weld_time": 0.04,
    },
    "pybullet": {"breaking_threshold": 0.2},
}
"""What it takes at 1/60: in a step of which a hand covers more than a contact foresees."""


def at(frame: int) -> TrackerSample:
    """Down within 0.3 s, then 20 cm along."""
    time = FRAME * frame
    down, along = (min(1.0, max(0.0, share)) for share in ((time - 0.1) / 0.3, (time - 0.5) / 0.4))
    place = np.array([[0.2 * along, 0.0, RESTS + HIGH - (HIGH + DEEP) * down]])
    return TrackerSample(time, place, np.array([rotation.IDENTITY]), np.zeros(0))


@ENGINES
@pytest.mark.parametrize("rate", [60, 240, 1000])
def test_a_hand_is_no_deeper_than_known(engine: Engine, rate: int) -> None:
    table = fixed("table", (Piece(Box((1.5, 1.0, THICK))),), "wood", (0.0, 0.0, -0.5 * THICK))
    scene = Scene("press", (table,), (rigid_hand(),), start=at(0))
    options: dict[str, object] = {"dt": 1.0 / rate}
    found = led(engine, scene, at, FRAMES, options | (COARSE[engine.name] if rate == 60 else {}))
    most, usual = REACHED[engine.name][rate]
    assert found.depths.max() <= most * MM
    # a median of 0.00 is known to its last digit
    assert np.median(found.depths[PRESSED]) <= max(usual, 5e-3) * MM
    # no overlap is also what a hand below the table has
    assert found.places[:, 0, 2].min() > 0.0
