"""A door in hinges closes on a hand and opens again: in the open, and before a wall half a hand behind it."""

from collections.abc import Callable

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, fixed, solid
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.cases import pair_table
from scenarios.building.expected import Sag
from scenarios.building.promises import FINITE, KEEPS_MOVING, NO_OVERLAP, NO_SHAKING, RIGHT_SIDE
from scenarios.motion.moving_bodies import about_z, given
from scenarios.scenario import Bound, Region, Scenario

SPEED, FARTHEST, WAITS = 0.8, 1.2, 1.0
"""Angular velocity of the door [rad/s], how far it turns [rad], and how long it stays there [s]."""
OPENED = 2.0 * FARTHEST / SPEED + WAITS
"""When it is open again [s]."""
AFTER = OPENED + 0.5
"""From then on [s] nothing is left of what it did."""
USER = (0.5, -0.4, 0.5)
"""Where the hand's user is, all the time [m]."""
THICK, LEFT, FIST = 0.04, 0.05, 0.05
"""Thickness of the door, what is left between it and the wall when it is closed, and radius of the hand [m]."""


def wall() -> Body:
    """A wall behind the closed door, parallel to it."""
    turn = rotation.from_axis_angle((0.0, 0.0, 1.0), -FARTHEST)
    x, y, z = rotation.rotate(turn, (0.5, -(0.5 * THICK + LEFT + 0.05), 0.5)).tolist()
    return fixed("wall", (Piece(Box((1.0, 0.1, 1.0)), orientation=about_z(-FARTHEST)),), "wood", (x, y, z))


def angle(time: float) -> float:
    """Angle of the door [rad]: closes, waits, opens."""
    closed = FARTHEST / SPEED
    return -SPEED * min(time, closed) + SPEED * float(np.clip(time - closed - WAITS, 0.0, closed))


def builder(name: str, *walls: Body) -> Callable[[], Scene]:
    """Return what builds a floor, walls, the door and the hand."""
    leaf, ball = (Piece(Box((0.8, THICK, 1.0)), (0.42, 0.0, 0.52)),), (Piece(Sphere(FIST)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    law = pair_table(("wood", "hand"), {("wood", "hand"): ContactLaw(0.0, 0.3)})

    def build() -> Scene:
        door = moving("door", leaf, "wood", joint=Hinges((Hinge((0.0, 0.0, 1.0), -2.0, 2.0),)))
        hand = rigid_avatar("hand", ball, solid(ball, 0.5), "hand")
        start = TrackerSample(0.0, np.array([(0.0, 0.0, 0.0), USER]), np.tile(rotation.IDENTITY, (2, 1)), np.zeros(1))
        return Scene(name, (floor, *walls), (door, hand), law, start=start)

    return build


def scenario(name: str, title: str, *walls: Body) -> Scenario:
    """Return the scene with these walls."""
    return Scenario(
        name=name,
        title=title,
        judged="That nothing overlaps or shakes; how far the hand is from its user once the door is open.",
        build=builder(name, *walls),
        motion=given(lambda time: {"door": angle(time)}),
        frames=330,
        bounds=(
            NO_OVERLAP, RIGHT_SIDE, FINITE, NO_SHAKING, KEEPS_MOVING,
            Bound("sag_error_max", 1e-6, "half a second after the door is open the hand is where its user is"),
        ),
        regions=(Region(("hand",), (-0.1, -1.2, 0.2), (1.2, 0.0, 0.8), "the hand stays before the door and the wall"),),
        expects={"sags": (Sag("hand", 0.0, AFTER),)},
    )


SCENARIOS = (
    scenario("closing_door", "A door closes on a hand."),
    scenario("closing_door_wall", "A door closes on a hand before a wall.", wall()),
)
