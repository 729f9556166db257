"""Bodies that move by themselves carry and push others: a belt, a lift, a turntable, and doors in hinges.

By equation 6 with its stiffness a lift sags by m g / K under a box. A door that cannot go on stops, and its engine reports it.
"""

from collections.abc import Iterable

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.cases import LAID, NOWHERE, driven, fixture, laws, loose, one_law, pieces_of, slab
from scenarios.building.expected import Carried, Course, Rest, Sag
from scenarios.building.promises import KEEPS_MOVING, KEEPS_TIME, NO_SHAKING, SOUND
from scenarios.building.things import disc
from scenarios.motion.rigid_hands import about_z, eased, given
from scenarios.scenario import Bound, Region, Scenario

BELT_SPEED, FRICTION = 1.0, 0.5
"""Speed of the belt [m/s], and friction of box and belt."""
ON_BELT: Vector = (-2.0, 0.0, 0.1 + LAID)
"""Where the box is laid on the belt [m]."""
LOAD, STIFFNESS = 5.0, 1e6
"""Mass of the box on the lift [kg], and stiffness of the lift [N/m]."""
LOW, RISE = 0.06, 0.5
"""Height of the lift's middle before it rises, and how far it does [m]."""
TURNS, TAKES = 3.0, 2.0
"""Angular velocity of the turntable [rad/s], and in how long it comes to it [s]: a box needs 18 % of its friction to stay."""
SWINGS, FARTHEST, WAITS = 0.8, 1.2, 1.0
"""Angular velocity of doors [rad/s], how far the one turns that closes on a hand [rad], and how long it stays there [s]."""
AFTER = 2.0 * FARTHEST / SWINGS + WAITS + 0.5
"""From then on [s] that door has no effect any more: it has been open for half a second."""
USER = (0.5, -0.4, 0.5)
"""Where the hand's user is, all the time [m]."""
LEAF, LEFT = Piece(Box((0.8, 0.04, 1.0)), (0.42, 0.0, 0.52)), 0.05
"""A door, and the way between it and the wall when it is closed [m]."""
EDGE, PITCH, BOXES = 0.18, 0.19, tuple(f"box_{k}" for k in range(8))
"""Edge of the boxes in a door's way, how far apart their middles are [m], and their names."""


def on_belt(time: float) -> Vector:
    """Return the closed form [m] of the box: friction brings it to the belt's speed, and then it goes with the belt."""
    push = FRICTION * 9.81
    slides = min(time, BELT_SPEED / push)
    return ON_BELT[0] + 0.5 * push * slides * slides + BELT_SPEED * (time - slides), 0.0, ON_BELT[2]


def table_angle(time: float) -> float:
    """Return the angle of the turntable [rad]: constant acceleration, then constant speed."""
    t = min(time, TAKES)
    return 0.5 * TURNS / TAKES * t * t + TURNS * (time - t)


def door_angle(time: float) -> float:
    """Return the angle of the door that closes on a hand [rad]: closes, waits, opens."""
    closed = FARTHEST / SWINGS
    return -SWINGS * min(time, closed) + SWINGS * float(np.clip(time - closed - WAITS, 0.0, closed))


def door() -> Avatar:
    """Return a door in hinges at the origin."""
    return moving("door", (LEAF,), "wood", joint=Hinges((Hinge((0.0, 0.0, 1.0), -2.0, 2.0),)))


def closing(name: str, title: str, walls: Iterable[Body] = ()) -> Scenario:
    """Return the scene of a door that closes on a hand."""
    start = TrackerSample(0.0, np.array([NOWHERE, USER]), np.tile(rotation.IDENTITY, (2, 1)), np.zeros(1))
    return Scenario(
        name, title, "That nothing overlaps or shakes; how far the hand is from its user once the door is open.",
        lambda: Scene(name, (slab(4.0, 4.0, "wood"), *walls), (door(), driven("hand", Sphere(0.05), 0.5, "hand")),
                      laws({("wood", "hand"): (0.0, 0.3)}), start=start),
        given(lambda time: {"door": door_angle(time)}), 330, family="closing_door",
        bounds=(
            *SOUND, NO_SHAKING, KEEPS_MOVING,
            Bound("sag_error_max", 1e-6, "half a second after the door is open the hand is where its user is"),
        ),
        regions=(Region(("hand",), (-0.1, -1.2, 0.2), (1.2, 0.0, 0.8), "the hand stays before the door and the wall"),),
        expects={"sags": (Sag("hand", 0.0, AFTER),)},
    )


def wall() -> Body:
    """Return a wall half a hand behind the closed door, parallel to it."""
    turn = rotation.from_axis_angle((0.0, 0.0, 1.0), -FARTHEST)
    x, y, z = rotation.rotate(turn, (0.5, -(0.5 * 0.04 + LEFT + 0.05), 0.5)).tolist()
    return fixture("wall", Piece(Box((1.0, 0.1, 1.0)), orientation=about_z(-FARTHEST)), "wood", (x, y, z))


def crowded() -> Scene:
    """Return three walls that keep eight boxes in two rows from going away, and a door."""
    walls = (
        ("back", (2.0, 0.1, 0.6), (0.4, -0.6, 0.3)), ("side", (0.1, 1.2, 0.6), (0.97, -0.6, 0.3)),
        ("near", (0.1, 0.45, 0.6), (0.1, -0.4, 0.3)),
    )
    places = ((0.25 + PITCH * (k % 4), -0.25 - PITCH * (k // 4), 0.5 * EDGE + LAID) for k in range(len(BOXES)))
    return Scene("door_and_boxes", (
        slab(4.0, 4.0, "wood"), *(fixture(name, Box(size), "wood", place) for name, size, place in walls),
        *(loose(name, Box((EDGE, EDGE, EDGE)), "box", 2.0, place) for name, place in zip(BOXES, places, strict=True)),
    ), (door(),), one_law(0.0, 0.4, ("wood", "box"), ("box", "box")))


def conveyor() -> Scene:
    """Return the belt and the box."""
    belt = moving("belt", pieces_of(Box((6.0, 0.6, 0.1))), "belt", surface_velocity=(BELT_SPEED, 0.0, 0.0))
    box = loose("box", Box((0.1, 0.1, 0.1)), "box", 1.0, ON_BELT)
    return Scene("conveyor", (box,), (belt,), laws({("belt", "box"): (0.0, FRICTION)}))


def lift() -> Scene:
    """Return a floor, the lift above it, and the box on the lift."""
    plate = moving("lift", pieces_of(Box((1.0, 1.0, 0.08))), "wood", position=(0.0, 0.0, LOW), stiffness=STIFFNESS)
    box = loose("box", Box((0.2, 0.2, 0.2)), "box", LOAD, (0.0, 0.0, LOW + 0.5 * 0.08 + 0.5 * 0.2 + LAID))
    return Scene("lift", (slab(4.0, 4.0, "wood"), box), (plate,), laws({("wood", "box"): (0.0, 0.5)}))


def turntable() -> Scene:
    """Return the table and the box."""
    box = loose("box", Box((0.1, 0.1, 0.1)), "box", 1.0, (0.2, 0.0, 0.5 * (0.04 + 0.1) + LAID))
    table = moving("table", (disc(32, 0.6, 0.04),), "wood")
    return Scene("turntable", (box,), (table,), laws({("wood", "box"): (0.0, 1.0)}))


SCENARIOS = (
    Scenario(
        "conveyor", "A box is laid on a running belt.", "How far the box is from where friction and the belt bring it.",
        conveyor, given(lambda time: {}), 240, 120,
        bounds=(
            *SOUND, KEEPS_TIME, Bound("course_error_max", 5e-3, "a substep of slip more or less is 4 mm of way at this speed"),
        ),
        regions=(Region(("box",), (-2.1, -0.1, 0.0), (2.5, 0.1, 0.2), "the box stays on the belt"),),
        expects={"courses": (Course("box", on_belt),)},
    ),
    Scenario(
        "lift", "A lift brings up a box.",
        "That the box comes along and does not slip; how far the lift is below where it should be.", lift,
        given(lambda time: {"lift": ((0.0, 0.0, LOW + RISE * eased(time, 0.3, 1.3)), rotation.IDENTITY)}), 300, 110,
        bounds=(
            *SOUND, KEEPS_MOVING, KEEPS_TIME,
            Bound("height_missing", 2.0 * (9.81 * LOAD / STIFFNESS), "the box comes up with the lift, less its sag m g / K"),
            Bound("grip_slip_max", 1e-4, "a box on a lift stays where it is on it"),
        ),
        regions=(Region(("box",), (-0.1, -0.1, 0.1), (0.1, 0.1, 0.8), "the box stays on the lift"),),
        expects={"carried": (Carried("box", ("lift",), 0.2),)},
    ),
    Scenario(
        "turntable", "A turntable turns with a box on it.", "How far the box drifts on the table.", turntable,
        given(lambda time: {"table": (NOWHERE, about_z(table_angle(time)))}), 600, 240,
        bounds=(
            *SOUND, KEEPS_MOVING, KEEPS_TIME,
            Bound("grip_slip_max", 1e-4, "friction holds it five times over: a tenth of a millimetre is not seen"),
        ),
        regions=(Region(("box",), (-0.5, -0.5, 0.0), (0.5, 0.5, 0.2), "the box stays on the table"),),
        expects={"carried": (Carried("box", ("table",), 0.1),)},
    ),
    closing("closing_door", "A door closes on a hand."),
    closing("closing_door_wall", "A door closes on a hand before a wall.", (wall(),)),
    Scenario(
        "door_and_boxes", "A door swings against boxes that cannot go away.",
        "That the door stops and the boxes come to rest.", crowded, given(lambda time: {"door": -min(SWINGS * time, 1.5)}),
        300, 180,
        bounds=(
            *SOUND, KEEPS_TIME, Bound("travel_missing", 0.0, "the door pushes the boxes together"),
            Bound("drift_max", 1e-4, "boxes between a door at rest and walls are at rest"),
        ),
        regions=(Region(BOXES, (0.1, -0.6, 0.0), (0.97, 0.2, 0.4), "the boxes stay between door and walls"),),
        expects={"rests": (Rest(BOXES, 2.0),), "travel": {"box_3": 0.01}},
    ),
)
