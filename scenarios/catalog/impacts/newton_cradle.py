"""Newton's cradle: five equal elastic balls in a row, the first comes in at 1 m/s, without strings and without gravity.

With gaps of 1 mm the impacts follow one another and the last ball takes all: 0, 0, 0, 0, 1. Touching balls are a question of the
law used: ours takes pairs one after another (eqs. 7 to 10), and `newton_cradle_touching` bounds how far the outcome is from the
gapped one's.
"""

from avatarsim.scene.body import ContactLaw, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from reference.closed_form import cradle_velocities
from scenarios.building.cases import LAID, NOWHERE, pair_table
from scenarios.building.expected import Course, steady
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Scenario

BALLS, RADIUS, MASS, SPEED = 5, 0.05, 0.5, 1.0
"""Number of balls, radius [m], mass [kg], speed of the first [m/s]."""
COMES = 0.1
"""Gap [m] before the first ball at the start."""
GAP = 1e-3
"""Gap [m] between the others."""
AFTER = 0.2
"""From then on [s] velocities are compared: twice the time until the first impact."""
NAMES = tuple(f"ball_{k}" for k in range(BALLS))


def build(name: str, gap: float) -> Scene:
    """The row along x, `gap` [m] between neighbours."""
    pieces = (Piece(Sphere(RADIUS)),)
    bodies = [simulated(NAMES[0], pieces, "steel", solid(pieces, MASS), (-COMES, 0.0, 0.0), velocity=(SPEED, 0.0, 0.0))]
    for k in range(1, BALLS):
        x = k * 2.0 * RADIUS + (k - 1) * gap
        bodies.append(simulated(NAMES[k], pieces, "steel", solid(pieces, MASS), (x, 0.0, 0.0)))
    materials = pair_table(("steel",), {("steel", "steel"): ContactLaw(1.0, 0.0)})
    return Scene(name, tuple(bodies), materials=materials, gravity=NOWHERE)


COURSES = tuple(
    Course(name, velocity=steady(speed, 0.0, 0.0), since=AFTER)
    for name, speed in zip(NAMES, cradle_velocities(BALLS, SPEED), strict=True)
)
KEPT = (
    NO_OVERLAP, FINITE,
    Bound("energy_gain_max", 1e-12, "no law of impact adds energy"),
    Bound("momentum_drift_max", 1e-11, "every impact takes from one what it gives to the other: 1e-12 for each of up to ten"),
)
EXPECTS = {"courses": COURSES, "isolated": (NAMES,), "alone": (NAMES,)}

SCENARIOS = (
    Scenario(
        name="newton_cradle",
        title="Five elastic balls with gaps of 1 mm; the first comes in.",
        judged="The last ball takes all the speed.",
        build=lambda: build("newton_cradle", GAP),
        motion=untracked(),
        frames=60,
        bounds=(*KEPT, Bound("velocity_error_max", 1e-9, "four impacts one after another, each of equal masses")),
        expects=EXPECTS,
    ),
    Scenario(
        name="newton_cradle_touching",
        title="The same without gaps: what happens is a question of the law of impact.",
        judged="Momentum and energy; how far the outcome is from 0, 0, 0, 0, 1.",
        build=lambda: build("newton_cradle_touching", LAID),
        motion=untracked(),
        frames=60,
        bounds=(*KEPT, Bound("velocity_error_max", 1e-9, "pairs one after another, as with gaps")),
        expects=EXPECTS,
    ),
)
