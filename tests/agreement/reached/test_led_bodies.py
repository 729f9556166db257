"""Depth and lag of driven bodies equal the known best of each engine.

A ball is driven 10 cm into a wall at 1 m/s, and a hand of fifteen ellipsoids 10 cm into a table and along it. The known best of
MuJoCo is over eleven ways to drive a body (mocap body and weld, servo, velocities), of PyBullet over six.
"""

from collections.abc import Callable

import numpy as np
import pytest

from avatarsim.engine import Engine, Settings
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from tests.agreement.rivals import STUDIED
from tests.agreement.runs import FRAME, MM, Array, depths, played, poses

RATES = pytest.mark.parametrize("rate", [60, 240, 1000])
"""Steps per second."""
RADIUS, MASS, FACE, DEEP, SPEED = 0.03, 0.5, 0.2, 0.1, 1.0
"""Radius [m] and mass [kg] of the ball; position of the wall's face [m], target depth in the wall [m], speed [m/s]."""
FREE = slice(3, 9)
"""Frames without contact in steady motion."""
BALL = {
    "mujoco": {60: (3.1, 0.03, 37.0), 240: (0.04, 0.03, 16.0), 1000: (1.0, 0.03, 4.0)},
    "pybullet": {60: (0.01, 0.01, 0.1), 240: (0.01, 0.01, 0.1), 1000: (0.01, 0.01, 0.1)},
}
"""Known maximum depth of the ball, depth while it is pressed, and lag in free motion [mm], by steps per second."""
HAND = {
    "mujoco": {60: (8.5, 0.18), 240: (1.6, 0.08), 1000: (0.17, 0.0)},
    "pybullet": {60: (0.69, 0.009), 240: (0.02, 0.009), 1000: (0.01, 0.009)},
}
"""Known maximum depth of the hand, and its median while it is pressed [mm].
Each column has the best of the settings that stay on their side of the table."""
COARSE: dict[str, dict[str, object]] = {
    "mujoco": {
        "integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1, "lead": 0.0, "weld_time": 0.04,
    },
    "pybullet": {"breaking_threshold": 0.2},
}
"""Settings of the hand at 1/60, where a step is longer than the look-ahead of a contact."""


def led_to(place: tuple[float, float, float], frame: int) -> TrackerSample:
    return TrackerSample(FRAME * frame, np.array([place]), np.array([rotation.IDENTITY]), np.zeros(0))


def ball_at(frame: int) -> TrackerSample:
    """Return the sample of the ball's motion along x, straight into the wall."""
    return led_to((min(SPEED * FRAME * frame, FACE - RADIUS + DEEP), 0.0, 0.0), frame)


def hand_at(frame: int) -> TrackerSample:
    """Return the hand's sample: 10 cm above the table (the palm touches at 14 mm), 10 cm below after 0.3 s, then 20 cm along."""
    time = FRAME * frame
    down, along = (min(1.0, max(0.0, share)) for share in ((time - 0.1) / 0.3, (time - 0.5) / 0.4))
    return led_to((0.2 * along, 0.0, 0.114 - 0.2 * down), frame)


def led(
    engine: Engine, scene: Scene, path: Callable[[int], TrackerSample], frames: int, options: dict[str, object]
) -> tuple[Array, Array]:
    """Return depths (F,) [m] and positions (F, 2, 3) [m] of the tuned preset along `path`, from its first sample on."""
    samples = [path(frame) for frame in range(1, frames + 1)]
    records = played(engine, scene, samples, Settings("tuned", options))[1:]
    return depths(scene, records), poses(records)[0]


@STUDIED
@RATES
def test_a_ball_is_no_deeper_and_no_later_than_known(engine: Engine, rate: int) -> None:
    pieces = (Piece(Sphere(RADIUS)),)
    wall = fixed("wall", (Piece(Box((0.6, 4.0, 4.0))),), "wood", (FACE + 0.3, 0.0, 0.0))
    scene = Scene("ball", (wall,), (rigid_avatar("hand", pieces, solid(pieces, MASS)),), start=ball_at(0))
    deep, places = led(engine, scene, ball_at, 50, {"dt": 1.0 / rate})
    most, pressed, late = BALL[engine.name][rate]
    assert deep.max() <= most * MM
    assert deep[-10:].max() <= pressed * MM
    wanted = np.array([ball_at(frame).positions[0, 0] for frame in range(1, 51)])
    assert np.abs(places[FREE, 1, 0] - wanted[FREE]).max() <= late * MM
    # and before the wall, not behind it
    assert places[:, 1, 0].max() < FACE


@STUDIED
@RATES
def test_a_hand_is_no_deeper_than_known(engine: Engine, rate: int) -> None:
    table = fixed("table", (Piece(Box((1.5, 1.0, 0.06))),), "wood", (0.0, 0.0, -0.03))
    scene = Scene("press", (table,), (rigid_hand(),), start=hand_at(0))
    deep, places = led(engine, scene, hand_at, 60, {"dt": 1.0 / rate, **(COARSE[engine.name] if rate == 60 else {})})
    most, usual = HAND[engine.name][rate]
    assert deep.max() <= most * MM
    # a median of 0.00 is known to its last digit; the hand meets the table after a quarter of a second
    assert np.median(deep[15:]) <= max(usual, 5e-3) * MM
    # a hand below the table has no overlap either
    assert places[:, 1, 2].min() > 0.0
