"""Dzhanibekov effect: a box that spins about its middle axis turns over again and again, in free space.

Box of 0.1 x 0.4 x 0.9 m, 10 kg, first angular velocity (0.1, 5, 0.1) rad/s. The spin about the middle axis crosses zero at 1.166,
4.194, 7.223 s and so on (Jacobi's elliptic functions).
"""

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from reference.closed_form import flip_times
from scenarios.building.cases import NOWHERE
from scenarios.building.expected import Flips
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Scenario

SIZE, MASS = (0.1, 0.4, 0.9), 10.0
"""Edges [m] and mass [kg] of the box."""
SPIN: Vector = (0.1, 5.0, 0.1)
"""First angular velocity [rad/s], about the axes of the box."""
SECONDS = 60.0
"""Length of the full run [s]: twenty flips."""


def build() -> Scene:
    """One box in empty space."""
    pieces = (Piece(Box(SIZE)),)
    box = simulated("box", pieces, "wood", solid(pieces, MASS), angular_velocity=SPIN)
    return Scene("dzhanibekov", (box,), gravity=NOWHERE)


def moments() -> Vector:
    """Principal moments of inertia [kg m^2] along x, y and z."""
    x, y, z = solid((Piece(Box(SIZE)),), MASS).inertia.diagonal().tolist()
    return x, y, z


SCENARIO = Scenario(
    name="dzhanibekov",
    title="A box spinning about its middle axis turns over again and again.",
    judged="When it turns over; angular momentum and energy.",
    build=build,
    motion=untracked(),
    frames=3600,
    short=180,
    bounds=(
        NO_OVERLAP, FINITE,
        Bound("flip_time_error_max", 1e-6, "Euler's equations have a closed form; errors grow from flip to flip"),
        Bound("angular_momentum_drift_max", 1e-10, "nothing acts on the box"),
        Bound("energy_drift_max", 1e-10, "nothing acts on the box"),
    ),
    expects={
        "flips": (Flips("box", 1, flip_times(moments(), SPIN, SECONDS)),),
        "isolated": (("box",),),
        "elastic": (("box",),),
        "nothing_touches": True,
    },
)
