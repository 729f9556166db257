"""Central impacts of spheres without gravity: pairs, a row of five (Newton's cradle), light balls on heavy ones (superball).

Closed forms: v_a' = (m_a - e m_b) v / (m_a + m_b), v_b' = (1 + e) m_a v / (m_a + m_b) when b is at rest; in a row with gaps the
last ball takes all; a light ball is thrown back at (3 M - m) / (M + m) v.
"""

from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Sphere
from reference.closed_form import cradle_velocities, superball_speed, two_spheres
from scenarios.building.cases import LAID, NOWHERE, laws, loose, one_law, slab
from scenarios.building.expected import Course, steady
from scenarios.building.promises import FINITE, NO_OVERLAP, SOUND
from scenarios.building.scenes import above, undriven
from scenarios.scenario import Bound, Scenario

AFTER, RADIUS = 0.2, 0.05
"""Time [s] from which velocities are compared, twice that of the first impact; radius of the spheres of pairs and rows [m]."""

PAIRS = tuple((ratio, e) for e in (0.0, 0.5, 1.0) for ratio in (1.0, 10.0, 1e3, 1e6))
"""Mass of the sphere that comes over that of the one that waits, which is 1 kg, and restitution."""
SPEED, GAP = 2.0, 0.2
"""Speed of the spheres that come [m/s], gap at the start [m]."""

ROW, ROW_SPEED, ROW_GAP, COMES = tuple(f"ball_{k}" for k in range(5)), 1.0, 1e-3, 0.1
"""Balls of the cradle, speed of the first [m/s], gaps between the others and before the first [m]."""

RATIOS = (0.01, 0.1, 1.0 / 3.0)
"""Mass of the light ball over that of the heavy one, which is 1 kg."""
HEAVY, LIGHT, FALLS, HEIGHT, BETWEEN = 0.1, 0.04, 3.0, 0.3, 1e-3
"""Radii of both [m], speed of both at the plate [m/s], gaps below the heavy ball and between the two at the start [m]."""


def names(ratio: float, e: float) -> tuple[str, str]:
    """Return the two spheres of a pair."""
    return f"comes_{ratio:g}_{e:g}", f"waits_{ratio:g}_{e:g}"


def pairs() -> Iterator[Body]:
    """Yield twelve pairs, each on its own line along x, a metre apart."""
    for k, (ratio, e) in enumerate(PAIRS):
        first, second = names(ratio, e)
        at = -(2.0 * RADIUS + GAP)
        yield loose(first, Sphere(RADIUS), f"e_{e:g}", ratio, (at, float(k), 0.0), velocity=(SPEED, 0.0, 0.0))
        yield loose(second, Sphere(RADIUS), f"e_{e:g}", 1.0, (0.0, float(k), 0.0))


def pair_courses() -> Iterator[Course]:
    """Yield the velocity of both after the impact; friction has nothing to do, so there is no spin."""
    for ratio, e in PAIRS:
        for name, speed in zip(names(ratio, e), two_spheres(ratio, 1.0, SPEED, 0.0, e), strict=True):
            yield Course(name, velocity=steady(speed, 0.0, 0.0), spin=steady(0.0, 0.0, 0.0), since=AFTER)


def row(gap: float) -> Iterator[Body]:
    """Yield the row along x, `gap` [m] between neighbours."""
    yield loose(ROW[0], Sphere(RADIUS), "steel", 0.5, (-COMES, 0.0, 0.0), velocity=(ROW_SPEED, 0.0, 0.0))
    for k in range(1, len(ROW)):
        yield loose(ROW[k], Sphere(RADIUS), "steel", 0.5, (k * 2.0 * RADIUS + (k - 1) * gap, 0.0, 0.0))


def cradle(name: str, title: str, judged: str, gap: float, reason: str) -> Scenario:
    """Return Newton's cradle with `gap` [m] between the balls that wait."""
    ends = zip(ROW, cradle_velocities(len(ROW), ROW_SPEED), strict=True)
    courses = tuple(Course(ball, velocity=steady(speed, 0.0, 0.0), since=AFTER) for ball, speed in ends)
    return undriven(
        name, title, judged, lambda: row(gap), one_law(1.0, 0.0, ("steel", "steel")), family="newton_cradle", gravity=NOWHERE,
        frames=60,
        bounds=(
            NO_OVERLAP, FINITE, Bound("energy_gain_max", 1e-12, "no law of impact adds energy"),
            Bound("momentum_drift_max", 1e-11, "an impact takes from one and gives to the other: 1e-12 for each of up to ten"),
            Bound("velocity_error_max", 1e-9, reason),
        ),
        expects={"courses": courses, "isolated": (ROW,), "alone": (ROW,)},
    )


def towers() -> Iterator[Body]:
    """Yield three towers of two balls over one plate, a metre apart."""
    yield slab(4.0, 2.0, "plate", "plate")
    for k, ratio in enumerate(RATIOS):
        x, low = k - 1.0, HEIGHT + HEAVY
        yield loose(f"heavy_{k}", Sphere(HEAVY), "ball", 1.0, (x, 0.0, low), velocity=(0.0, 0.0, -FALLS))
        high = low + HEAVY + BETWEEN + LIGHT
        yield loose(f"light_{k}", Sphere(LIGHT), "ball", ratio, (x, 0.0, high), velocity=(0.0, 0.0, -FALLS))


def tower_courses() -> Iterator[Course]:
    """Yield both balls of each tower after both impacts."""
    for k, ratio in enumerate(RATIOS):
        left = two_spheres(1.0, ratio, FALLS, -FALLS, 1.0)[0]
        yield Course(f"light_{k}", velocity=steady(0.0, 0.0, superball_speed(ratio, 1.0, FALLS)), since=AFTER)
        yield Course(f"heavy_{k}", velocity=steady(0.0, 0.0, left), since=AFTER)


TWO_BY_TWO = tuple(names(ratio, e) for ratio, e in PAIRS)

SCENARIOS = (
    undriven(
        "two_spheres", "Twelve pairs of spheres meet head on: mass ratios 1 to 1e6, restitution 0, 0.5 and 1.",
        "Velocities after the impact, and momentum.", pairs, laws({(f"e_{e:g}", f"e_{e:g}"): (e, 0.5) for _, e in PAIRS}),
        gravity=NOWHERE, frames=60,
        bounds=(
            NO_OVERLAP, FINITE,
            Bound("velocity_error_max", 1e-9, "momentum and eq. 8 fix both velocities; nothing but rounding is left"),
            Bound("spin_error_max", 1e-9, "a central impact turns nothing"),
            Bound("momentum_drift_max", 1e-12, "eq. 7 takes from one what it gives to the other: rounding of one impact"),
            Bound("energy_gain_max", 1e-12, "no restitution up to 1 adds energy"),
        ),
        expects={"courses": tuple(pair_courses()), "isolated": TWO_BY_TWO, "alone": TWO_BY_TWO},
    ),
    cradle(
        "newton_cradle", "Five elastic balls with gaps of 1 mm; the first comes in.", "The last ball takes all the speed.",
        ROW_GAP, "four impacts one after another, each of equal masses",
    ),
    cradle(
        "newton_cradle_touching", "The same without gaps: what happens is a question of the law of impact.",
        "Momentum and energy; how far the outcome is from 0, 0, 0, 0, 1.", LAID, "pairs one after another, as with gaps",
    ),
    undriven(
        "superball", "Light balls on heavy ones fall on a plate, all impacts elastic.",
        "The speed at which the light ball is thrown back, nearly three times its own.",
        towers, one_law(1.0, 0.0, ("plate", "ball"), ("ball", "ball")), gravity=NOWHERE, frames=60,
        bounds=(
            *SOUND, Bound("velocity_error_max", 1e-9, "two elastic impacts in a stated order; nothing but rounding is left"),
            Bound("energy_drift_max", 1e-12, "elastic impacts keep the energy"),
        ),
        regions=(above(0.0, "heavy_*", "light_*", reason="the plate is not passed"),),
        expects={
            "courses": tuple(tower_courses()), "elastic": tuple((f"heavy_{k}", f"light_{k}") for k in range(len(RATIOS))),
        },
    ),
)
