"""Spheres hit a plate at 5 m/s under angles of 20, 45 and 70 degrees, with friction 0.1, 0.3 and 1 and without gravity.

Closed form: where friction can stop the slip, mu (1 + e) v_n >= 2/7 v_t, the sphere leaves at 5/7 v_t; else at
v_t - mu (1 + e) v_n and spinning.
"""

from collections.abc import Iterator
from math import cos, radians, sin

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Sphere
from reference.closed_form import Oblique, oblique_bounce
from scenarios.building.cases import NOWHERE, laws, loose, slab
from scenarios.building.expected import Course, steady
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

SPEED, RADIUS, MASS, RESTITUTION = 5.0, 0.05, 0.5, 0.5
"""Speed of all spheres [m/s], their radius [m], mass [kg], and the restitution of every pair."""
FRICTIONS = (0.1, 0.3, 1.0)
FALL = 0.1
"""Time [s] of all impacts. Velocities are compared from twice that on, late enough for contacts of tens of milliseconds."""
CASES = {f"ball_{angle:g}_{friction:g}": (angle, friction) for friction in FRICTIONS for angle in (20.0, 45.0, 70.0)}
"""Angle between the path and the plate's normal [deg], and friction: five spheres stick, four slide on."""


def after(angle: float, friction: float) -> Oblique:
    """The closed form of one case; `angle` in degrees."""
    a = radians(angle)
    return oblique_bounce(SPEED * cos(a), SPEED * sin(a), friction, RESTITUTION, RADIUS)


def bodies() -> Iterator[Body]:
    """One plate for all, its top at z = 0, and nine spheres that reach it at the same instant."""
    yield slab(20.0, 8.0, "plate", "plate")
    for k, (name, (angle, friction)) in enumerate(CASES.items()):
        velocity = (SPEED * sin(radians(angle)), 0.0, -SPEED * cos(radians(angle)))
        start = (-FALL * velocity[0], 0.5 * (k - 4), RADIUS - FALL * velocity[2])
        yield loose(name, Sphere(RADIUS), f"rubber_{friction:g}", MASS, start, velocity=velocity)


def courses() -> Iterator[Course]:
    """Velocity and spin of each sphere after its impact."""
    for name, case in CASES.items():
        end = after(*case)
        velocity, spin = steady(end.tangential, 0.0, end.normal), steady(0.0, end.spin, 0.0)
        yield Course(name, velocity=velocity, spin=spin, since=2.0 * FALL)


SCENARIO = undriven(
    "oblique_bounce", "Nine spheres hit a plate under three angles with three coefficients of friction.",
    "Velocity and spin after the impact: sticking where friction suffices, sliding where it does not.", bodies,
    laws({(f"rubber_{friction:g}", "plate"): (RESTITUTION, friction) for friction in FRICTIONS}), gravity=NOWHERE, frames=60,
    bounds=(
        *SOUND,
        Bound("velocity_error_max", 1e-6, "eqs 7 to 10 fix it; the gap at which bodies meet, 2e-8 m, moves it by 4e-7 m/s"),
        Bound("spin_error_max", 2e-5, "as the velocity, over the radius of 0.05 m"), NO_ENERGY,
    ),
    regions=(above(0.0, "ball_*", reason="the plate is not passed"),),
    expects={"courses": tuple(courses()), "alone": each_alone(CASES)},
)
