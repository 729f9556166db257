"""Tunnelling: balls of 1 cm fly at a wall of 1 cm with 2 to 1000 m/s, each from 20 starts spread over the way of one frame.

No gravity, elastic. Closed form: contact at (d - r) / v, d from the ball's centre to the wall's face;
then back at the same speed.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import wall_contact_time
from scenarios.building.cases import NOWHERE, pair_table
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, RENDERED, Bound, Region, Scenario

RADIUS, THICK = 0.01, 0.01
"""Radius of the balls and thickness of the wall [m]."""
SPEEDS = (2.0, 10.0, 30.0, 100.0, 300.0, 1000.0)
"""[m/s]; at 1000 a ball passes 17 m in one frame."""
STARTS = 20
"""Starting points per speed, spread over one frame's way."""
BEFORE = 3.3 * RENDERED
"""Time [s] from the nearest start to the wall: every ball has been seen flying."""
APART = 0.1
"""Distance of neighbouring lanes [m]."""
MASS = 0.03
"""Mass of a ball [kg]."""
CASES = tuple((speed, k) for speed in SPEEDS for k in range(STARTS))


def distance(speed: float, k: int) -> float:
    """From the ball's centre to the wall's middle at the start [m]."""
    return speed * (BEFORE + RENDERED * k / STARTS) + RADIUS + 0.5 * THICK


def build() -> Scene:
    """The wall stands across x at 0; lanes of one speed lie beside each other, speeds above each other."""
    wide, high = APART * (STARTS + 1), APART * (len(SPEEDS) + 1)
    bodies: list[Body] = [fixed("wall", (Piece(Box((THICK, wide, high))),), "wall")]
    pieces = (Piece(Sphere(RADIUS)),)
    for speed, k in CASES:
        y, z = APART * (k - 0.5 * (STARTS - 1)), APART * (SPEEDS.index(speed) - 0.5 * (len(SPEEDS) - 1))
        start, mass = (-distance(speed, k), y, z), solid(pieces, MASS)
        bodies.append(simulated(f"ball_{speed:g}_{k}", pieces, "ball", mass, start, velocity=(speed, 0.0, 0.0)))
    materials = pair_table(("ball", "wall"), {("ball", "wall"): ContactLaw(1.0, 0.0)})
    return Scene("tunnelling", tuple(bodies), materials=materials, gravity=NOWHERE)


def there_and_back(speed: float, k: int, y: float, z: float) -> OfTime:
    """Place [m] of a ball at a time [s]: to the wall and back the same way."""
    away = distance(speed, k)
    due = wall_contact_time(away, RADIUS, THICK, speed)
    return lambda time: (-away + speed * (time if time <= due else 2.0 * due - time), y, z)


def courses() -> tuple[Course, ...]:
    """Where each ball is at any time: a contact found late by t seconds leaves it 2 v t off its way."""
    found = []
    for body in build().bodies[1:]:
        _, speed, k = body.name.split("_")
        found.append(Course(body.name, there_and_back(float(speed), int(k), *body.position[1:])))
    return tuple(found)


SCENARIO = Scenario(
    name="tunnelling",
    title="A hundred and twenty balls fly at a thin wall with 2 to 1000 m/s.",
    judged="How many are stopped, and when each meets the wall.",
    build=build,
    motion=untracked(),
    frames=20,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("escaped_bodies", 0.0, "a wall stops what cannot pass it, at any speed"),
        Bound(
            "course_error_max", 2.1e-6,
            "the time of contact is (d - r) / v; a gap of 1e-6 m is contact, and a ball that turns there is twice that off",
        ),
    ),
    regions=(Region(("ball_*",), (-INFINITE,) * 3, (0.0, INFINITE, INFINITE), "nothing gets through the wall"),),
    expects={"courses": courses()},
)
