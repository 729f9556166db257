"""Torque-free rotation: a slender rod, one inertia a thousandth of the others, spins at 100 rad/s almost about its thin axis.

No gravity and nothing to touch. Angular momentum and energy must stay for a minute; the thin axis turns 16 times a second.
"""

import numpy as np

from avatarsim.scene.body import Mass, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece
from scenarios.building.cases import NOWHERE
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Scenario

RADIUS, LENGTH, MASS = 0.01, 0.5, 1.0
"""Radius and length [m] of the rod, its mass [kg]."""
MOMENTS = (0.02, 0.02001, 2e-5)
"""Principal moments [kg m^2]: slender, and not quite round."""
FLIES = (0.5, 0.0, 0.0)
"""Velocity [m/s]."""
SPIN = (3.0, 2.0, 100.0)
"""First angular velocity [rad/s], about the rod's own axes."""


def build() -> Scene:
    """One rod in empty space."""
    pieces = (Piece(Capsule(RADIUS, LENGTH)),)
    rod = simulated("rod", pieces, "metal", Mass(MASS, inertia=np.diag(MOMENTS)), velocity=FLIES, angular_velocity=SPIN)
    return Scene("slender_spin", (rod,), gravity=NOWHERE)


SCENARIO = Scenario(
    name="slender_spin",
    title="A slender rod spins fast, almost about its thin axis.",
    judged="Angular momentum and energy over a minute.",
    build=build,
    motion=untracked(),
    frames=3600,
    short=120,
    bounds=(
        NO_OVERLAP, FINITE,
        Bound("angular_momentum_drift_max", 1e-10, "nothing acts on the rod"),
        Bound("energy_drift_max", 1e-10, "nothing acts on the rod"),
        Bound("travel_missing", 0.0, "the rod also flies: half a metre a second"),
    ),
    expects={"isolated": (("rod",),), "elastic": (("rod",),), "nothing_touches": True, "travel": {"rod": 0.3}},
)
