"""Bodies turn in empty space, where nothing acts on them: a box about its middle axis, and a slender rod about its thin one.

The box turns over again and again (Dzhanibekov): the spin about its middle axis crosses zero at 1.166, 4.194, 7.223 s and so on,
by Jacobi's elliptic functions.
"""

import numpy as np

from avatarsim.scene.body import Mass, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Capsule
from reference.closed_form import flip_times
from scenarios.building.cases import NOWHERE, loose, pieces_of
from scenarios.building.expected import Flips
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.building.scenes import undriven
from scenarios.scenario import Bound

BOX, MASS = Box((0.1, 0.4, 0.9)), 10.0
"""The box [m], and its mass [kg]."""
BOX_SPIN: Vector = (0.1, 5.0, 0.1)
"""First angular velocity of the box [rad/s], about its own axes."""
SECONDS = 60.0
"""Length of the full runs [s]: the box turns over twenty times, the rod's thin axis goes round 960 times."""
MOMENTS = (0.02, 0.02001, 2e-5)
"""Principal moments of the rod [kg m^2]: slender, and not quite round."""
KEPT = (
    Bound("angular_momentum_drift_max", 1e-10, "nothing acts on the body"),
    Bound("energy_drift_max", 1e-10, "nothing acts on the body"),
)


def moments() -> Vector:
    """Principal moments of inertia of the box [kg m^2] along x, y and z."""
    x, y, z = solid(pieces_of(BOX), MASS).inertia.diagonal().tolist()
    return x, y, z


SCENARIOS = (
    undriven(
        "dzhanibekov", "A box spinning about its middle axis turns over again and again.",
        "When it turns over; angular momentum and energy.", lambda: (loose("box", BOX, "wood", MASS, spin=BOX_SPIN),),
        family="dzhanibekov", gravity=NOWHERE, frames=3600, short=180,
        bounds=(
            NO_OVERLAP, FINITE,
            Bound("flip_time_error_max", 1e-6, "Euler's equations have a closed form; errors grow from flip to flip"), *KEPT,
        ),
        expects={
            "flips": (Flips("box", 1, flip_times(moments(), BOX_SPIN, SECONDS)),), "isolated": (("box",),),
            "elastic": (("box",),), "nothing_touches": True,
        },
    ),
    undriven(
        "slender_spin", "A slender rod spins fast, almost about its thin axis.", "Angular momentum and energy over a minute.",
        lambda: (
            loose("rod", Capsule(0.01, 0.5), "metal", Mass(1.0, inertia=np.diag(MOMENTS)), velocity=(0.5, 0.0, 0.0),
                  spin=(3.0, 2.0, 100.0)),
        ),
        family="slender_spin", gravity=NOWHERE, frames=3600, short=120,
        bounds=(NO_OVERLAP, FINITE, *KEPT, Bound("travel_missing", 0.0, "the rod also flies: half a metre a second")),
        expects={"isolated": (("rod",),), "elastic": (("rod",),), "nothing_touches": True, "travel": {"rod": 0.3}},
    ),
)
