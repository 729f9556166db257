"""Oblique impacts with friction: spheres hit a plate at 5 m/s under angles of 20, 45 and 70 degrees, friction 0.1, 0.3 and 1.

Without gravity, so that nothing changes before and after the impact. Closed form: where friction can stop the slip,
mu (1 + e) v_n >= 2/7 v_t, the sphere leaves at 5/7 v_t; else at v_t - mu (1 + e) v_n and spinning.
"""

from math import cos, radians, sin

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import Oblique, oblique_bounce
from scenarios.building.cases import NOWHERE, pair_table
from scenarios.building.expected import Course, steady
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SPEED, RADIUS, MASS, RESTITUTION = 5.0, 0.05, 0.5, 0.5
"""Speed of all spheres [m/s], their radius [m], mass [kg], and the restitution of every pair."""
ANGLES = (20.0, 45.0, 70.0)
"""Between the path and the plate's normal [deg]."""
FRICTIONS = (0.1, 0.3, 1.0)
"""Together with the angles: five that stick, four that slide on."""
FALL = 0.1
"""Time [s] of the impact, the same for all."""
AFTER = 2.0 * FALL
"""From then on [s] velocities are compared: late enough for engines whose contact takes tens of milliseconds."""
CASES = tuple((angle, friction) for friction in FRICTIONS for angle in ANGLES)


def after(angle: float, friction: float) -> Oblique:
    """The closed form of one case; `angle` in degrees."""
    a = radians(angle)
    return oblique_bounce(SPEED * cos(a), SPEED * sin(a), friction, RESTITUTION, RADIUS)


def build() -> Scene:
    """One plate for all, its top at z = 0, and nine spheres that reach it at the same instant."""
    bodies: list[Body] = [fixed("plate", (Piece(Box((20.0, 8.0, 0.2))),), "plate", (0.0, 0.0, -0.1))]
    pieces = (Piece(Sphere(RADIUS)),)
    for k, (angle, friction) in enumerate(CASES):
        velocity = (SPEED * sin(radians(angle)), 0.0, -SPEED * cos(radians(angle)))
        start = (-FALL * velocity[0], 0.5 * (k - 4), RADIUS - FALL * velocity[2])
        material = f"rubber_{friction:g}"
        bodies.append(simulated(f"ball_{angle:g}_{friction:g}", pieces, material, solid(pieces, MASS), start, velocity=velocity))
    stated = {(f"rubber_{friction:g}", "plate"): ContactLaw(RESTITUTION, friction) for friction in FRICTIONS}
    names = ["plate", *(f"rubber_{friction:g}" for friction in FRICTIONS)]
    return Scene("oblique_bounce", tuple(bodies), materials=pair_table(names, stated), gravity=NOWHERE)


def courses() -> tuple[Course, ...]:
    """Velocity and spin of each sphere after its impact."""
    found = []
    for angle, friction in CASES:
        end = after(angle, friction)
        velocity, spin = steady(end.tangential, 0.0, end.normal), steady(0.0, end.spin, 0.0)
        found.append(Course(f"ball_{angle:g}_{friction:g}", velocity=velocity, spin=spin, since=AFTER))
    return tuple(found)


SCENARIO = Scenario(
    name="oblique_bounce",
    title="Nine spheres hit a plate under three angles with three coefficients of friction.",
    judged="Velocity and spin after the impact: sticking where friction suffices, sliding where it does not.",
    build=build,
    motion=untracked(),
    frames=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("velocity_error_max", 1e-6, "eqs 7 to 10 fix it; the gap at which bodies meet, 2e-8 m, moves it by 4e-7 m/s"),
        Bound("spin_error_max", 2e-5, "as the velocity, over the radius of 0.05 m"),
        Bound("energy_gain_max", 1e-9, "an impact with friction takes energy"),
    ),
    regions=(Region(("ball_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "the plate is not passed"),),
    expects={"courses": courses(), "alone": tuple((f"ball_{angle:g}_{friction:g}",) for angle, friction in CASES)},
)
