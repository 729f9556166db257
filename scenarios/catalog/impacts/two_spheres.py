"""Central impacts: two spheres meet head on, with mass ratios from 1 to a million and restitution 0, 0.5 and 1, without gravity.

Closed form: v_a' = (m_a - e m_b) v / (m_a + m_b), v_b' = (1 + e) m_a v / (m_a + m_b) when b was at rest.
"""

from avatarsim.scene.body import Body, ContactLaw, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from reference.closed_form import two_spheres
from scenarios.building.cases import NOWHERE, pair_table
from scenarios.building.expected import Course, steady
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Scenario

RATIOS = (1.0, 10.0, 1e3, 1e6)
"""Mass of the sphere that comes over that of the one that waits, which is 1 kg."""
RESTITUTIONS = (0.0, 0.5, 1.0)
RADIUS, SPEED, GAP = 0.05, 2.0, 0.2
"""Radius [m] of all, speed [m/s] of those that come, gap [m] at the start: they meet after 0.1 s."""
AFTER = 0.2
"""From then on [s] velocities are compared."""
CASES = tuple((ratio, e) for e in RESTITUTIONS for ratio in RATIOS)


def names(ratio: float, e: float) -> tuple[str, str]:
    """The two spheres of a case."""
    return f"comes_{ratio:g}_{e:g}", f"waits_{ratio:g}_{e:g}"


def build() -> Scene:
    """Twelve pairs, each on its own line along x, a metre apart."""
    bodies: list[Body] = []
    pieces = (Piece(Sphere(RADIUS)),)
    for k, (ratio, e) in enumerate(CASES):
        first, second = names(ratio, e)
        material = f"e_{e:g}"
        at = -(2.0 * RADIUS + GAP)
        bodies.append(simulated(first, pieces, material, solid(pieces, ratio), (at, float(k), 0.0), velocity=(SPEED, 0.0, 0.0)))
        bodies.append(simulated(second, pieces, material, solid(pieces, 1.0), (0.0, float(k), 0.0)))
    stated = {(f"e_{e:g}", f"e_{e:g}"): ContactLaw(e, 0.5) for e in RESTITUTIONS}
    materials = pair_table([f"e_{e:g}" for e in RESTITUTIONS], stated)
    return Scene("two_spheres", tuple(bodies), materials=materials, gravity=NOWHERE)


def courses() -> tuple[Course, ...]:
    """Velocity of both after the impact; friction has nothing to do, so there is no spin."""
    found = []
    for ratio, e in CASES:
        ends = two_spheres(ratio, 1.0, SPEED, 0.0, e)
        for name, speed in zip(names(ratio, e), ends, strict=True):
            found.append(Course(name, velocity=steady(speed, 0.0, 0.0), spin=steady(0.0, 0.0, 0.0), since=AFTER))
    return tuple(found)


SCENARIO = Scenario(
    name="two_spheres",
    title="Twelve pairs of spheres meet head on: mass ratios 1 to 1e6, restitution 0, 0.5 and 1.",
    judged="Velocities after the impact, and momentum.",
    build=build,
    motion=untracked(),
    frames=60,
    bounds=(
        NO_OVERLAP, FINITE,
        Bound("velocity_error_max", 1e-9, "momentum and eq. 8 fix both velocities; nothing but rounding is left"),
        Bound("spin_error_max", 1e-9, "a central impact turns nothing"),
        Bound("momentum_drift_max", 1e-12, "eq. 7 takes from one what it gives to the other: rounding of one impact"),
        Bound("energy_gain_max", 1e-12, "no restitution up to 1 adds energy"),
    ),
    expects={
        "courses": courses(),
        "isolated": tuple(names(ratio, e) for ratio, e in CASES),
        "alone": tuple(names(ratio, e) for ratio, e in CASES),
    },
)
