"""A driven ball is led 10 cm into a wall at 1 m/s and held: as deep as each engine is known to be at its best, and as late.

Known of MuJoCo is the best of eleven ways to drive a body (mocap body and weld, servo, velocities), of PyBullet of six; ours are
below all of them, but for the lag of ways that go through the wall.
"""

from functools import cache

import numpy as np
import pytest

from avatarsim.engine import Engine
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from tests.agreement.reached.driven import FRAME, MM, Led, led
from tests.agreement.rivals import ENGINES, RIVALS

RADIUS, MASS, FACE, DEEP, SPEED = 0.03, 0.5, 0.2, 0.1, 1.0
"""Of the ball [m], [kg]; where the wall begins [m], how far the ball is led into it [m], how fast [m/s]."""
FRAMES, FREE = 50, slice(3, 9)
"""Half a second of them are at rest in the wall; in the second the way is free and the motion steady."""
REACHED = {
    "mujoco": {60: (3.1, 0.03, 37.0), 240: (0.04, 0.03, 16.0), 1000: (1.0, 0.03, 4.0)},
    "pybullet": {60: (0.01, 0.01, 0.1), 240: (0.01, 0.01, 0.1), 1000: (0.01, 0.01, 0.1)},
}
"""Known depth at most and while held, and lag in free motion [mm], by steps per second; no lag is known to the last digit."""


def at(frame: int) -> TrackerSample:
    """Straight in along x."""
    x = min(SPEED * FRAME * frame, FACE - RADIUS + DEEP)
    return TrackerSample(FRAME * frame, np.array([[x, 0.0, 0.0]]), np.array([rotation.IDENTITY]), np.zeros(0))


@cache
def ball_led(name: str, rate: int) -> Led:
    """The ball at so many steps per second."""
    pieces = (Piece(Sphere(RADIUS)),)
    wall = fixed("wall", (Piece(Box((0.6, 4.0, 4.0))),), "wood", (FACE + 0.3, 0.0, 0.0))
    scene = Scene("ball", (wall,), (rigid_avatar("hand", pieces, solid(pieces, MASS)),), start=at(0))
    engine = next(engine for engine in RIVALS if engine.name == name)
    return led(engine, scene, at, FRAMES, {"dt": 1.0 / rate})


@ENGINES
@pytest.mark.parametrize("rate", [60, 240, 1000])
def test_a_ball_is_no_deeper_and_no_later_than_known(engine: Engine, rate: int) -> None:
    most, held, late = REACHED[engine.name][rate]
    found = ball_led(engine.name, rate)
    assert found.depths.max() <= most * MM
    assert found.depths[-10:].max() <= held * MM
    wanted = np.array([at(frame).positions[0, 0] for frame in range(1, FRAMES + 1)])
    assert np.abs(found.places[FREE, 0, 0] - wanted[FREE]).max() <= late * MM
    # and before the wall, not behind it
    assert found.places[:, 0, 0].max() < FACE
