"""Boxes slide until they stop, bodies on three balls brake, and leaning rods slide over rough floors (Painleve's paradox).

A box stops after v^2 / (2 mu g), straight on; a friction pyramid gets the diagonal wrong by up to 41 %. A body with one ball on
a rough lane shows the load on it: with the centre of mass at height h, the rough foot at x_1 and two others at x_2 on ice,
balance is three equations for three loads: N_1 = m g x_2 / (x_2 - x_1 + mu h). For a rod at arctan 2 from upright no finite
force is consistent from mu = 4/3 on; impulses are, and only invariants are judged.
"""

from collections.abc import Iterator
from math import atan, cos, radians, sin

import numpy as np

from avatarsim.scene.body import Body, Mass
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from reference.closed_form import stop_distance, stop_time, tripod_load
from scenarios.building.cases import LAID, NOWHERE, fixture, laws, loose, slab, turned_by
from scenarios.building.expected import Course, Stop, steady, uniform
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound, Scenario

GRAVITY = 9.81
FORWARD = (3.0, 0.0, 0.0)
"""First velocity of the bodies on three balls and of the rods [m/s]."""

SPEED, FRICTION, SIZE = 3.0, 0.5, (0.4, 0.4, 0.1)
"""First speed [m/s], friction and edges [m] of the boxes: they stop after 0.6116 s and 0.9174 m, and do not tip."""
BOXES = {f"box_{angle:g}": radians(angle) for angle in (0.0, 22.5, 45.0)}
"""Directions from the x axis [rad]; a box is turned with its way."""

RADIUS, MASS, ROUGH, WIDE, LANE = 0.1, 3.0, 0.2, 0.4, 1.4
"""Radius of the balls [m], mass of a body on three [kg], friction of its rough lane; distance of feet and of lanes [m]."""
FEET = {"three_0": (0.3, -0.3), "three_1": (0.1, -0.5), "three_2": (-0.4, 0.2), "three_3": (-0.2, 0.4)}
"""Places along the way [m] of the rough foot and of the two smooth ones, from the centre of mass: it leads, or it trails."""

RODS = {f"rod_{friction:g}": friction for friction in (0.5, 1.2, 1.4, 2.0, 5.0)}
"""Friction of each rod."""
LENGTH, THIN, LEAN = 1.0, 0.01, atan(2.0)
"""Length of a rod's axis and radius [m], and angle from upright [rad], the lower end ahead."""


def boxes() -> Iterator[Body]:
    """Yield one floor, its top at z = 0, and three boxes, one of them to each direction."""
    yield slab(8.0, 8.0)
    for k, (name, angle) in enumerate(BOXES.items()):
        start, velocity = (-1.0, 1.2 * (k - 1), 0.5 * SIZE[2] + LAID), (SPEED * cos(angle), SPEED * sin(angle), 0.0)
        yield loose(name, Box(SIZE), "box", 2.0, start, turned_by((0.0, 0.0, 1.0), angle), velocity)


def at_rate(rate: int) -> Scenario:
    """Return the three boxes at so many frames per second, for a second."""
    way, by = stop_distance(SPEED, FRICTION, GRAVITY), stop_time(SPEED, FRICTION, GRAVITY)
    return undriven(
        "stop_distance" if rate == 60 else f"stop_distance_{rate}",
        f"Boxes slide at 3 m/s in three directions until they stop, at {rate} frames per second.",
        "How far, and how straight.", boxes, laws({("floor", "box"): (0.0, FRICTION)}), frames=rate, dt=1.0 / rate,
        family="stop_distance",
        bounds=(
            *SOUND, Bound("stop_distance_error_max", 1e-5, "v^2 / (2 mu g) in every direction, to a ten-millionth"),
            Bound("stop_direction_error_max", 1e-5, "friction acts against the motion alone"), NO_ENERGY,
        ),
        regions=(above(0.0, "box_*"),),
        expects={
            "stops": tuple(Stop(name, way, (cos(angle), sin(angle), 0.0), by) for name, angle in BOXES.items()),
            "alone": each_alone(BOXES),
        },
    )


def on_three() -> Iterator[Body]:
    """Yield bodies, each of which straddles a rough lane between two of ice, all tops at z = 0."""
    for k, (name, (rough, smooth)) in enumerate(FEET.items()):
        y = LANE * (k - 1.5)
        for kind, lane, aside in (("rough", "rough", 0.0), ("left", "ice", WIDE), ("right", "ice", -WIDE)):
            yield fixture(f"{kind}_{k}", Box((12.0, 0.2, 0.2)), lane, (3.0, y + aside, -0.1))
        feet = tuple(Piece(Sphere(RADIUS), at) for at in ((rough, 0.0, 0.0), (smooth, WIDE, 0.0), (smooth, -WIDE, 0.0)))
        mass = Mass(MASS, inertia=0.1 * MASS * np.eye(3))
        yield loose(name, feet, "ball", mass, (0.0, y, RADIUS + LAID), velocity=FORWARD)


def braking() -> Iterator[Course]:
    """Yield uniform braking, for the first second."""
    for k, (name, (rough, smooth)) in enumerate(FEET.items()):
        brake = (-ROUGH * tripod_load(MASS, GRAVITY, rough, smooth, ROUGH, RADIUS) / MASS, 0.0, 0.0)
        way = uniform((0.0, LANE * (k - 1.5), RADIUS), FORWARD, brake)
        yield Course(name, way, uniform(FORWARD, brake), steady(*NOWHERE))


def rods() -> Iterator[Body]:
    """Yield five rods side by side, each of a roughness of its own."""
    yield slab(20.0, 8.0)
    across, high = LENGTH**2 / 12.0, 0.5 * LENGTH * cos(LEAN) + THIN + LAID
    mass = Mass(1.0, inertia=np.diag([across, across, 1e-3 * across]))
    for k, (name, friction) in enumerate(RODS.items()):
        at, turn = (0.0, 1.4 * (k - 2), high), turned_by((0.0, 1.0, 0.0), -LEAN)
        yield loose(name, Capsule(THIN, LENGTH), f"mu_{friction:g}", mass, at, turn, velocity=FORWARD)


SCENARIOS = (
    *map(at_rate, (30, 60, 240)),
    undriven(
        "triball", "Bodies on three balls slide along, one ball of each on a rough lane.",
        "How hard they brake: the load on the rough ball, from three equations of balance.", on_three,
        laws({("rough", "ball"): (0.0, ROUGH)}, "ice"), frames=60,
        bounds=(
            *SOUND, Bound("course_error_max", 2e-6, "the load fixes the braking: 1e-6 m, and 1e-6 m of air below the feet"),
            Bound("velocity_error_max", 2e-6, "as the place, over a second"), NO_ENERGY,
        ),
        regions=(above(0.0, "three_*", reason="nothing falls through a lane"),),
        expects={"courses": tuple(braking()), "alone": each_alone(FEET)},
    ),
    undriven(
        "painleve", "Leaning rods slide with their lower end ahead over ever rougher floors.",
        "That the paradox ends in a number, above the floor, without more energy than before.", rods,
        laws({(f"mu_{friction:g}", "floor"): (0.0, friction) for friction in RODS.values()}), frames=60,
        bounds=(
            *SOUND, NO_ENERGY, Bound("travel_missing", 0.0, "rods fall over: the middle comes down by 0.15 m at least"),
            Bound("halted_frames", 0.0, "the paradox does not stop the world"),
        ),
        regions=(above(0.0, "rod_*"),), expects={"alone": each_alone(RODS), "travel": dict.fromkeys(RODS, 0.15)},
    ),
)
