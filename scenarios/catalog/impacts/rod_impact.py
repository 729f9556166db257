"""Eccentric impacts: rods and cubes hit a smooth plate off their centre, without spin and without gravity: eq. 9 with arms.

A rod comes down on one end, a cube on one corner. Closed form: impulse -(1 + e) v_n / (1 / m + n . (I^-1 (r x n) x r)) at the
point that meets the plate. Rods turn about a main axis and cubes have none, so the spin then stays as it is.
"""

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from avatarsim.spatial import rotation
from reference.closed_form import point_impact
from scenarios.building.cases import NOWHERE, pair_table, turned_by
from scenarios.building.expected import Course, steady
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

RESTITUTIONS = (0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 0.9, 1.0)
ROD, THIN, LEAN = 0.6, 0.02, float(np.radians(35.0))
"""Length of the rod's segment and its radius [m]; its angle from upright: steep, or its other end follows at once."""
EDGE = 0.2
"""Edge of the cube [m]."""
CUBE_TURN: Quaternion = turned_by((0.790, 0.576, 0.210), 0.8656)
"""How the cube stands: one corner lowest, beside its centre, and the others well above it."""
MASS, SPEED, FALL = 1.5, 2.0, 0.1
"""Mass [kg], speed [m/s], time until the impact [s], of all."""
AFTER, UNTIL = 0.13, 0.155
"""Velocities are compared between these times [s]; later a corner may meet the plate again."""


def turns() -> dict[str, tuple[Piece, Quaternion, Vector]]:
    """Kind -> its piece, how it stands, and the arm from its centre to the point that meets the plate [m]."""
    lean = turned_by((0.0, 1.0, 0.0), LEAN)
    end = -0.5 * ROD * np.array([np.sin(LEAN), 0.0, np.cos(LEAN)]) - np.array([0.0, 0.0, THIN])
    corners = 0.5 * EDGE * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    turned = rotation.rotate(np.array(CUBE_TURN), corners)
    lowest = turned[np.argmin(turned[:, 2])]
    return {
        "rod": (Piece(Capsule(THIN, ROD)), lean, _vector(end)),
        "cube": (Piece(Box((EDGE, EDGE, EDGE))), CUBE_TURN, _vector(lowest)),
    }


def _vector(values: np.typing.NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def build() -> Scene:
    """One plate, its top at z = 0; two rows along x, rods and cubes, a metre apart."""
    bodies: list[Body] = [fixed("plate", (Piece(Box((12.0, 6.0, 0.2))),), "plate", (0.0, 0.0, -0.1))]
    for row, (kind, (piece, turn, arm)) in enumerate(turns().items()):
        for k, e in enumerate(RESTITUTIONS):
            at = (k - 3.5, 2.0 * row - 1.0, SPEED * FALL - arm[2])
            mass = solid((piece,), MASS)
            bodies.append(simulated(f"{kind}_{e:g}", (piece,), f"e_{e:g}", mass, at, turn, velocity=(0.0, 0.0, -SPEED)))
    names = ["plate", *(f"e_{e:g}" for e in RESTITUTIONS)]
    stated = {(f"e_{e:g}", "plate"): ContactLaw(e, 0.0) for e in RESTITUTIONS}
    return Scene("rod_impact", tuple(bodies), materials=pair_table(names, stated), gravity=NOWHERE)


def courses() -> tuple[Course, ...]:
    """Velocity and spin after the impact."""
    found = []
    for kind, (piece, turn, arm) in turns().items():
        frame = rotation.to_matrix(np.array(turn))
        inertia = frame @ solid((piece,), MASS).inertia @ frame.T
        for e in RESTITUTIONS:
            _, velocity, spin = point_impact(MASS, inertia, (0.0, 0.0, -SPEED), NOWHERE, arm, (0.0, 0.0, 1.0), e)
            found.append(Course(f"{kind}_{e:g}", None, steady(*velocity), steady(*spin), AFTER, UNTIL))
    return tuple(found)


BODIES = tuple(f"{kind}_{e:g}" for kind in ("rod", "cube") for e in RESTITUTIONS)

SCENARIO = Scenario(
    name="rod_impact",
    title="Rods fall on one end and cubes on one corner, on a smooth plate, with eight coefficients of restitution.",
    judged="Velocity and spin after an impact that does not go through the centre of mass.",
    build=build,
    motion=untracked(),
    frames=42,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("velocity_error_max", 1e-6, "eq. 9 with arms fixes the velocity; 1e-6 of the speed, at any restitution"),
        Bound("spin_error_max", 1e-5, "as the velocity, over an arm of a tenth of a metre"),
        Bound("energy_gain_max", 1e-9, "an impact adds no energy"),
    ),
    regions=(Region(("rod_*", "cube_*"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "the plate is not passed"),),
    expects={"courses": courses(), "alone": tuple((name,) for name in BODIES)},
)
