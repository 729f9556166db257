"""Superball: a light ball just above a heavy one, both falling on a plate at 3 m/s, all impacts elastic, without gravity.

The heavy ball bounces first and then throws the light one back at (3 M - m) / (M + m) v; at m = M / 3 it keeps nothing itself.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import superball_speed, two_spheres
from scenarios.building.cases import NOWHERE, pair_table
from scenarios.building.expected import Course, steady
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

RATIOS = (0.01, 0.1, 1.0 / 3.0)
"""Mass of the light ball over that of the heavy one, which is 1 kg."""
SPEED = 3.0
"""Speed of both at the plate [m/s]."""
HEAVY, LIGHT = 0.1, 0.04
"""Radii [m]."""
HEIGHT, GAP = 0.3, 1e-3
"""Gap [m] under the heavy ball, met after 0.1 s, and between the two: with a gap the order of the impacts is not in doubt."""
AFTER = 0.2
"""From then on [s] velocities are compared."""


def build() -> Scene:
    """Three towers of two balls over one plate, a metre apart."""
    bodies: list[Body] = [fixed("plate", (Piece(Box((4.0, 2.0, 0.2))),), "plate", (0.0, 0.0, -0.1))]
    heavy, light = (Piece(Sphere(HEAVY)),), (Piece(Sphere(LIGHT)),)
    down = (0.0, 0.0, -SPEED)
    for k, ratio in enumerate(RATIOS):
        x, low = k - 1.0, HEIGHT + HEAVY
        bodies.append(simulated(f"heavy_{k}", heavy, "ball", solid(heavy, 1.0), (x, 0.0, low), velocity=down))
        high = low + HEAVY + GAP + LIGHT
        bodies.append(simulated(f"light_{k}", light, "ball", solid(light, ratio), (x, 0.0, high), velocity=down))
    elastic = ContactLaw(1.0, 0.0)
    materials = pair_table(("plate", "ball"), {("plate", "ball"): elastic, ("ball", "ball"): elastic})
    return Scene("superball", tuple(bodies), materials=materials, gravity=NOWHERE)


def courses() -> tuple[Course, ...]:
    """Both balls of each tower after both impacts."""
    found = []
    for k, ratio in enumerate(RATIOS):
        up = superball_speed(ratio, 1.0, SPEED)
        left = two_spheres(1.0, ratio, SPEED, -SPEED, 1.0)[0]
        found.append(Course(f"light_{k}", velocity=steady(0.0, 0.0, up), since=AFTER))
        found.append(Course(f"heavy_{k}", velocity=steady(0.0, 0.0, left), since=AFTER))
    return tuple(found)


SCENARIO = Scenario(
    name="superball",
    title="Light balls on heavy ones fall on a plate, all impacts elastic.",
    judged="The speed at which the light ball is thrown back, nearly three times its own.",
    build=build,
    motion=untracked(),
    frames=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("velocity_error_max", 1e-9, "two elastic impacts in a stated order; nothing but rounding is left"),
        Bound("energy_drift_max", 1e-12, "elastic impacts keep the energy"),
    ),
    regions=(Region(("heavy_*", "light_*"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "the plate is not passed"),),
    expects={"courses": courses(), "elastic": tuple((f"heavy_{k}", f"light_{k}") for k in range(len(RATIOS)))},
)
