"""Impacts that are not central: spheres hit a plate obliquely, rods and cubes on one end or corner; boxes tumble on a floor.

Closed forms, without gravity: where friction can stop the slip, mu (1 + e) v_n >= 2/7 v_t, a sphere leaves at 5/7 v_t, else at
v_t - mu (1 + e) v_n and spinning; a rod or cube without friction has the impulse -(1 + e) v_n / (1 / m + n . (I^-1 (r x n) x
r)) at the point that meets the plate. Each tumbling box is judged by itself: none can hide a gain of energy behind another's
loss.
"""

from collections.abc import Iterator
from math import cos, radians, sin

import numpy as np

from avatarsim.scene.body import Body, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.shape import Box, Capsule, Shape, Sphere
from avatarsim.spatial import rotation
from reference.closed_form import Oblique, oblique_bounce, point_impact
from scenarios.building.cases import NOWHERE, laws, loose, pieces_of, slab, turned_by
from scenarios.building.expected import Course, steady
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

FALL = 0.1
"""Time [s] of all impacts with the plate."""
SPEED, RADIUS, RESTITUTION = 5.0, 0.05, 0.5
"""Speed of all spheres [m/s], their radius [m], and the restitution of every pair."""
FRICTIONS = (0.1, 0.3, 1.0)
SPHERES = {f"ball_{angle:g}_{friction:g}": (angle, friction) for friction in FRICTIONS for angle in (20.0, 45.0, 70.0)}
"""Angle between the path and the plate's normal [deg], and friction: five spheres stick, four slide on."""

RESTITUTIONS = (0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 0.9, 1.0)
ROD, THIN, LEAN, EDGE = 0.6, 0.02, radians(35.0), 0.2
"""Length of the rod's segment and its radius [m], its angle from upright: or its other end follows; edge of the cube [m]."""
CUBE_TURN: Quaternion = turned_by((0.790, 0.576, 0.210), 0.8656)
"""Turn of the cube: one corner lowest, off the line below its centre, and the others well above it."""
MASS, DOWN = 1.5, (0.0, 0.0, -2.0)
"""Mass [kg] and velocity [m/s] of rods and cubes."""

BOXES = {f"box_{e:g}_{mu:g}": (e, mu) for e in (0.0, 0.3, 0.6, 0.9) for mu in (0.0, 0.3, 0.6, 1.0)}
"""Restitution and friction of each tumbling box."""


def after(angle: float, friction: float) -> Oblique:
    """Return the closed form of one sphere; `angle` in degrees."""
    a = radians(angle)
    return oblique_bounce(SPEED * cos(a), SPEED * sin(a), friction, RESTITUTION, RADIUS)


def spheres() -> Iterator[Body]:
    """Yield one plate for all, its top at z = 0, and nine spheres that reach it at the same instant."""
    yield slab(20.0, 8.0, "plate", "plate")
    for k, (name, (angle, friction)) in enumerate(SPHERES.items()):
        velocity = (SPEED * sin(radians(angle)), 0.0, -SPEED * cos(radians(angle)))
        start = (-FALL * velocity[0], 0.5 * (k - 4), RADIUS - FALL * velocity[2])
        yield loose(name, Sphere(RADIUS), f"rubber_{friction:g}", 0.5, start, velocity=velocity)


def sphere_courses() -> Iterator[Course]:
    """Yield the velocity and spin after the impact, late enough for contacts of tens of milliseconds."""
    for name, case in SPHERES.items():
        end = after(*case)
        velocity, spin = steady(end.tangential, 0.0, end.normal), steady(0.0, end.spin, 0.0)
        yield Course(name, velocity=velocity, spin=spin, since=2.0 * FALL)


def kinds() -> dict[str, tuple[Shape, Quaternion, Vector]]:
    """Return kind -> its shape, how it is turned, and the arm from its centre to the point that meets the plate [m]."""
    lean = turned_by((0.0, 1.0, 0.0), LEAN)
    end = -0.5 * ROD * np.array([np.sin(LEAN), 0.0, np.cos(LEAN)]) - np.array([0.0, 0.0, THIN])
    corners = 0.5 * EDGE * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    turned = rotation.rotate(np.array(CUBE_TURN), corners)
    (a, b, c), (x, y, z) = end.tolist(), turned[np.argmin(turned[:, 2])].tolist()
    return {"rod": (Capsule(THIN, ROD), lean, (a, b, c)), "cube": (Box((EDGE, EDGE, EDGE)), CUBE_TURN, (x, y, z))}


def rods() -> Iterator[Body]:
    """Yield one plate, its top at z = 0; two rows along x, rods and cubes, two metres apart."""
    yield slab(12.0, 6.0, "plate", "plate")
    for row, (kind, (shape, turn, arm)) in enumerate(kinds().items()):
        for k, e in enumerate(RESTITUTIONS):
            at = (k - 3.5, 2.0 * row - 1.0, -DOWN[2] * FALL - arm[2])
            yield loose(f"{kind}_{e:g}", shape, f"e_{e:g}", MASS, at, turn, velocity=DOWN)


def rod_courses() -> Iterator[Course]:
    """Yield the velocity and spin after the impact, which stay: rods turn about a main axis, cubes have none."""
    for kind, (shape, turn, arm) in kinds().items():
        frame = rotation.to_matrix(np.array(turn))
        inertia = frame @ solid(pieces_of(shape), MASS).inertia @ frame.T
        for e in RESTITUTIONS:
            _, velocity, spin = point_impact(MASS, inertia, DOWN, NOWHERE, arm, (0.0, 0.0, 1.0), e)
            yield Course(f"{kind}_{e:g}", None, steady(*velocity), steady(*spin), 0.13, 0.155)


def boxes() -> Iterator[Body]:
    """Yield sixteen boxes over one floor, five metres apart, every one turned and spinning in a way of its own."""
    yield slab(40.0, 40.0)
    for k, name in enumerate(BOXES):
        at = (5.0 * (k % 4 - 1.5), 5.0 * (k // 4 - 1.5), 0.6)
        turn, spin = turned_by((0.6, 0.0, 0.8), 0.3 + 0.35 * k), (4.0 - 0.5 * k, 3.0, -2.0 + 0.3 * k)
        yield loose(name, Box((0.2, 0.3, 0.4)), name, 2.0, at, turn, (1.0, 0.5, 0.0), spin)


ROD_COURSES = tuple(rod_courses())

SCENARIOS = (
    undriven(
        "oblique_bounce", "Nine spheres hit a plate under three angles with three coefficients of friction.",
        "Velocity and spin after the impact: sticking where friction suffices, sliding where it does not.", spheres,
        laws({(f"rubber_{friction:g}", "plate"): (RESTITUTION, friction) for friction in FRICTIONS}), gravity=NOWHERE,
        frames=60,
        bounds=(
            *SOUND,
            Bound("velocity_error_max", 1e-6, "eqs 7 to 10 fix it; the gap at which bodies meet, 2e-8 m, moves it by 4e-7 m/s"),
            Bound("spin_error_max", 2e-5, "as the velocity, over the radius of 0.05 m"), NO_ENERGY,
        ),
        regions=(above(0.0, "ball_*", reason="the plate is not passed"),),
        expects={"courses": tuple(sphere_courses()), "alone": each_alone(SPHERES)},
    ),
    undriven(
        "rod_impact",
        "Rods fall on one end and cubes on one corner, on a smooth plate, with eight coefficients of restitution.",
        "Velocity and spin after an impact that does not go through the centre of mass.", rods,
        laws({(f"e_{e:g}", "plate"): (e, 0.0) for e in RESTITUTIONS}), gravity=NOWHERE, frames=42,
        bounds=(
            *SOUND, Bound("velocity_error_max", 1e-6, "eq. 9 with arms fixes the velocity; 1e-6 of the speed"),
            Bound("spin_error_max", 1e-5, "as the velocity, over an arm of a tenth of a metre"), NO_ENERGY,
        ),
        regions=(above(0.0, "rod_*", "cube_*", reason="the plate is not passed"),),
        expects={"courses": ROD_COURSES, "alone": each_alone(course.body for course in ROD_COURSES)},
    ),
    undriven(
        "tumbling_box", "Sixteen boxes tumble over the floor, with restitution 0 to 0.9 and friction 0 to 1.",
        "Energy of every box in every frame.", boxes, laws({(name, "floor"): law for name, law in BOXES.items()}),
        frames=240, short=90,
        bounds=(
            *SOUND, NO_ENERGY, Bound("travel_missing", 0.0, "all come down"),
            Bound("halted_frames", 0.0, "no box hangs in the air"),
        ),
        regions=(above(0.0, "box_*"),), expects={"alone": each_alone(BOXES), "travel": dict.fromkeys(BOXES, 0.2)},
    ),
)
