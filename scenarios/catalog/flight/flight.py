"""Bodies fly and turn with nothing or one point to touch: thrown bodies, free rotation, a rod that falls over, and a top.

Closed forms: z = h + v t - g t^2 / 2. A box that turns about its middle axis turns over again and again (Dzhanibekov), by
Jacobi's elliptic functions. A rod on a smooth floor turns at w^2 = 12 g (cos a0 - cos a) / (L (1 + 3 sin^2 a)), a the angle
from upright; round ends change nothing. A smooth table pushes a top at its tip alone and straight up, so its spin stays;
`reference.closed_form.top_precession` is the mean rate of its axis.
"""

import math

import numpy as np

from avatarsim.scene.body import Mass, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import EARTH
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Sphere
from reference.closed_form import flip_times, rod_angular_velocity, top_precession
from scenarios.building.cases import LAID, NOWHERE, fixture, laws, loose, pieces_of, slab, turned_by
from scenarios.building.expected import Course, Flips, Pivot, Top, steady, uniform
from scenarios.building.promises import FINITE, KEEPS_TIME, NO_OVERLAP, SOUND
from scenarios.building.scenes import above, undriven
from scenarios.scenario import INFINITE, Bound, Drop, Region

BALL, BOX, HEIGHT = Sphere(0.05), Box((0.2, 0.2, 0.2)), 1.0
"""The thrown bodies, and the way of a second ball down to a slab, which shows that an engine sees contact at all [m]."""
THROWN: Vector = (2.0, 1.0, 6.0)
"""First velocity of ball and box [m/s]: up for 0.6 s, back at its height after 1.22 s."""
SPIN: Vector = (3.0, -2.0, 5.0)
"""First angular velocity of the box [rad/s]; a cube keeps it."""
FROM: dict[str, Vector] = {"ball": (0.0, 0.0, 5.0), "box": (0.0, 3.0, 5.0)}
SPEED = uniform(THROWN, EARTH)

TURNING, TURNS = Box((0.1, 0.4, 0.9)), (0.1, 5.0, 0.1)
"""The box that turns over [m], twenty times in a minute, and its first angular velocity about its own axes [rad/s]."""
MOMENTS = (0.02, 0.02001, 2e-5)
"""Principal moments of the rod that spins fast [kg m^2]: slender, and not quite round."""
KEPT = (
    Bound("angular_momentum_drift_max", 1e-10, "nothing acts on the body"),
    Bound("energy_drift_max", 1e-10, "nothing acts on the body"),
)

LENGTH, RADIUS, START = 1.0, 0.01, 0.1
"""Length of the axis and radius of the rod that falls over [m], and its first angle from upright [rad]."""
ACROSS = LENGTH**2 / 12.0

SIDES, RIM_RADIUS, RIM, MASS = 24, 0.03, (0.03, 0.04), 0.1
"""Sides and radius [m] of the top, a cone on its tip with a rim from one height to the other [m]; its mass [kg]."""
LEAN, TOP_SPIN = 0.2, 200.0
"""First lean of its axis [rad], and spin about it [rad/s]."""


def moments(piece: Piece, mass: float) -> Vector:
    """Return moments of inertia [kg m^2] along x, y and z."""
    x, y, z = solid((piece,), mass).inertia.diagonal().tolist()
    return x, y, z


def piece() -> Piece:
    """Return the top, its origin in its centre of mass."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = RIM_RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    corners = np.vstack([np.zeros((1, 3)), *(np.insert(ring, 2, z, axis=1) for z in RIM)])
    return Piece(ConvexHull(corners - np.array(solid(pieces_of(ConvexHull(corners)), MASS).centre)))


def reach() -> float:
    """Return the distance [m] from the tip to the centre of mass."""
    shape = piece().shape
    assert isinstance(shape, ConvexHull)
    return -float(shape.vertices[:, 2].min())


def precession() -> float:
    """Return the mean rate at which the axis of the top goes round [rad/s]."""
    across, _, along = moments(piece(), MASS)
    return top_precession(across, along, MASS, reach(), TOP_SPIN, LEAN, 9.81)


SCENARIOS = (
    undriven(
        "free_flight", "A ball and a turning box are thrown through the air; another ball falls on a slab.",
        "Place and velocity at every frame against the parabola.",
        lambda: (
            fixture("slab", Box((1.0, 1.0, 0.1)), "wood", (-3.0, 0.0, -0.05)),
            loose("ball", BALL, "wood", 1.0, FROM["ball"], velocity=THROWN),
            loose("box", BOX, "wood", 1.0, FROM["box"], velocity=THROWN, spin=SPIN),
            loose("falls", BALL, "wood", 1.0, (-3.0, 0.0, BALL.radius + HEIGHT)),
        ),
        frames=90,
        bounds=(
            *SOUND, Bound("course_error_max", 1e-9, "the parabola is exact at any frame time; only rounding is left"),
            Bound("velocity_error_max", 1e-9, "v - g t, likewise"), Bound("spin_error_max", 1e-9, "a cube keeps its spin"),
            Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v- of the ball that lands"),
        ),
        regions=(above(0.0, "falls", reason="the slab is not passed"),),
        expects={
            "drops": (Drop("falls", "slab", 0.3, HEIGHT),),
            "courses": (
                Course("ball", uniform(FROM["ball"], THROWN, EARTH), SPEED),
                Course("box", uniform(FROM["box"], THROWN, EARTH), SPEED, steady(*SPIN)),
            ),
        },
    ),
    undriven(
        "dzhanibekov", "A box spinning about its middle axis turns over again and again.",
        "When it turns over; angular momentum and energy.", lambda: (loose("box", TURNING, "wood", 10.0, spin=TURNS),),
        gravity=NOWHERE, frames=3600, short=180,
        bounds=(
            NO_OVERLAP, FINITE,
            Bound("flip_time_error_max", 1e-6, "Euler's equations have a closed form; errors grow from flip to flip"), *KEPT,
        ),
        expects={
            "flips": (Flips("box", 1, flip_times(moments(Piece(TURNING), 10.0), TURNS, 60.0)),), "isolated": (("box",),),
            "elastic": (("box",),), "nothing_touches": True,
        },
    ),
    undriven(
        "slender_spin", "A slender rod spins fast, almost about its thin axis.", "Angular momentum and energy over a minute.",
        lambda: (
            loose("rod", Capsule(0.01, 0.5), "metal", Mass(1.0, inertia=np.diag(MOMENTS)), velocity=(0.5, 0.0, 0.0),
                  spin=(3.0, 2.0, 100.0)),
        ),
        gravity=NOWHERE, frames=3600, short=120,
        bounds=(NO_OVERLAP, FINITE, *KEPT, Bound("travel_missing", 0.0, "the rod also flies: half a metre a second")),
        expects={"isolated": (("rod",),), "elastic": (("rod",),), "nothing_touches": True, "travel": {"rod": 0.3}},
    ),
    undriven(
        "falling_rod", "A thin rod falls over on a frictionless floor.",
        "Its angular speed at every angle; that its centre comes straight down.",
        lambda: (
            slab(4.0, 4.0, "ice"),
            loose("rod", Capsule(RADIUS, LENGTH), "rod", Mass(1.0, inertia=np.diag([ACROSS, ACROSS, 1e-4 * ACROSS])),
                  (0.0, 0.0, 0.5 * LENGTH * math.cos(START) + RADIUS + LAID), turned_by((0.0, 1.0, 0.0), START)),
        ),
        laws({("ice", "rod"): (0.0, 0.0)}), frames=75,
        bounds=(
            *SOUND, Bound("pivot_rate_error_max", 5e-3, "energy fixes the speed; a thousandth of the 5.4 rad/s at the end"),
            Bound("pivot_missing", 0.0, "it falls: from 0.1 rad it is down after 0.85 s"),
            Bound("energy_gain_max", 1e-9, "a floor without friction gives nothing"),
        ),
        regions=(Region(("rod",), (-1e-6, -1e-6, 0.0), (1e-6, 1e-6, INFINITE), "nothing pushes the rod sideways"),),
        expects={
            # followed until just before it lies
            "pivots": (Pivot("rod", lambda angle: rod_angular_velocity(START, max(angle, START), LENGTH, 9.81), 1.5),),
            "alone": (("rod",),),
        },
    ),
    undriven(
        "top", "A top spins on a smooth table.", "Its spin, and how fast its axis goes round; overlap.",
        lambda: (
            slab(2.0, 2.0, "table", "table"),
            loose("top", piece(), "top", MASS, (0.0, 0.0, reach() * math.cos(LEAN) + LAID), turned_by((0.0, 1.0, 0.0), LEAN),
                  spin=(TOP_SPIN * math.sin(LEAN), 0.0, TOP_SPIN * math.cos(LEAN))),
        ),
        laws({("table", "top"): (0.0, 0.0)}), frames=300, short=120,
        bounds=(
            *SOUND, KEEPS_TIME,
            Bound("axis_spin_error_max", 1.0, "no torque acts about its axis; half a percent is not seen"),
            Bound("precession_error_max", 0.1, "by the closed form, give or take the part of a nod in which the time ends"),
            Bound("energy_gain_max", 1e-6, "nothing gives it energy"),
        ),
        regions=(Region(("top",), (-0.5, -0.5, 0.0), (0.5, 0.5, 0.1), "the top neither falls through nor flies away"),),
        expects={"tops": (Top("top", TOP_SPIN, precession()),), "alone": (("top",),)},
    ),
)
