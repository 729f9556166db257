"""Rods fall on one end and cubes on one corner, on a smooth plate, without spin and without gravity: eq. 9 with arms.

Closed form: impulse -(1 + e) v_n / (1 / m + n . (I^-1 (r x n) x r)) at the point that meets the plate. Rods turn about a main
axis and cubes have none, so the spin then stays as it is.
"""

from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.shape import Box, Capsule, Shape
from avatarsim.spatial import rotation
from reference.closed_form import point_impact
from scenarios.building.cases import NOWHERE, laws, loose, pieces_of, slab, turned_by
from scenarios.building.expected import Course, steady
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

RESTITUTIONS = (0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 0.9, 1.0)
ROD, THIN, LEAN = 0.6, 0.02, float(np.radians(35.0))
"""Length of the rod's segment and its radius [m]; its angle from upright: steep, or its other end follows at once."""
EDGE = 0.2
"""Edge of the cube [m]."""
CUBE_TURN: Quaternion = turned_by((0.790, 0.576, 0.210), 0.8656)
"""How the cube is turned: one corner lowest, beside its centre, and the others well above it."""
MASS, SPEED, FALL = 1.5, 2.0, 0.1
"""Mass [kg], speed [m/s], time until the impact [s], of all."""
AFTER, UNTIL = 0.13, 0.155
"""Velocities are compared between these times [s]; later a corner may meet the plate again."""


def turns() -> dict[str, tuple[Shape, Quaternion, Vector]]:
    """Kind -> its shape, how it is turned, and the arm from its centre to the point that meets the plate [m]."""
    lean = turned_by((0.0, 1.0, 0.0), LEAN)
    end = -0.5 * ROD * np.array([np.sin(LEAN), 0.0, np.cos(LEAN)]) - np.array([0.0, 0.0, THIN])
    corners = 0.5 * EDGE * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    turned = rotation.rotate(np.array(CUBE_TURN), corners)
    (a, b, c), (x, y, z) = end.tolist(), turned[np.argmin(turned[:, 2])].tolist()
    return {"rod": (Capsule(THIN, ROD), lean, (a, b, c)), "cube": (Box((EDGE, EDGE, EDGE)), CUBE_TURN, (x, y, z))}


def bodies() -> Iterator[Body]:
    """One plate, its top at z = 0; two rows along x, rods and cubes, two metres apart."""
    yield slab(12.0, 6.0, "plate", "plate")
    for row, (kind, (shape, turn, arm)) in enumerate(turns().items()):
        for k, e in enumerate(RESTITUTIONS):
            at = (k - 3.5, 2.0 * row - 1.0, SPEED * FALL - arm[2])
            yield loose(f"{kind}_{e:g}", shape, f"e_{e:g}", MASS, at, turn, velocity=(0.0, 0.0, -SPEED))


def courses() -> Iterator[Course]:
    """Velocity and spin after the impact."""
    for kind, (shape, turn, arm) in turns().items():
        frame = rotation.to_matrix(np.array(turn))
        inertia = frame @ solid(pieces_of(shape), MASS).inertia @ frame.T
        for e in RESTITUTIONS:
            _, velocity, spin = point_impact(MASS, inertia, (0.0, 0.0, -SPEED), NOWHERE, arm, (0.0, 0.0, 1.0), e)
            yield Course(f"{kind}_{e:g}", None, steady(*velocity), steady(*spin), AFTER, UNTIL)


SCENARIO = undriven(
    "rod_impact",
    "Rods fall on one end and cubes on one corner, on a smooth plate, with eight coefficients of restitution.",
    "Velocity and spin after an impact that does not go through the centre of mass.", bodies,
    laws({(f"e_{e:g}", "plate"): (e, 0.0) for e in RESTITUTIONS}), gravity=NOWHERE, frames=42,
    bounds=(
        *SOUND, Bound("velocity_error_max", 1e-6, "eq. 9 with arms fixes the velocity; 1e-6 of the speed, at any restitution"),
        Bound("spin_error_max", 1e-5, "as the velocity, over an arm of a tenth of a metre"), NO_ENERGY,
    ),
    regions=(above(0.0, "rod_*", "cube_*", reason="the plate is not passed"),),
    expects={"courses": tuple(courses()), "alone": each_alone(f"{kind}_{e:g}" for kind in turns() for e in RESTITUTIONS)},
)
