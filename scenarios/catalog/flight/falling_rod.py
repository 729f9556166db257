"""A thin rod falls over on a frictionless floor; its centre comes straight down.

Closed form: w^2 = 12 g (cos a0 - cos a) / (L (1 + 3 sin^2 a)), a the angle from upright. It holds for a rod with round ends too,
since the floor pushes through the middle of the end.
"""

import numpy as np

from avatarsim.scene.body import Mass
from avatarsim.scene.shape import Capsule
from reference.closed_form import rod_angular_velocity
from scenarios.building.cases import LAID, laws, loose, slab, turned_by
from scenarios.building.expected import Pivot
from scenarios.building.promises import SOUND
from scenarios.building.scenes import undriven
from scenarios.scenario import INFINITE, Bound, Region

LENGTH, RADIUS, MASS, START, GRAVITY = 1.0, 0.01, 1.0, 0.1, 9.81
"""Length of the rod's axis and its radius [m], mass [kg], first angle from upright [rad], gravity [m/s^2]."""
ACROSS = MASS * LENGTH**2 / 12.0
AT = (0.0, 0.0, 0.5 * LENGTH * float(np.cos(START)) + RADIUS + LAID)
"""Middle of the rod [m], which leans towards +x on its lower end."""

SCENARIO = undriven(
    "falling_rod", "A thin rod falls over on a frictionless floor.",
    "Its angular speed at every angle; that its centre comes straight down.",
    lambda: (
        slab(4.0, 4.0, "ice"),
        loose("rod", Capsule(RADIUS, LENGTH), "rod", Mass(MASS, inertia=np.diag([ACROSS, ACROSS, 1e-4 * ACROSS])), AT,
              turned_by((0.0, 1.0, 0.0), START)),
    ),
    laws({("ice", "rod"): (0.0, 0.0)}), frames=75,
    bounds=(
        *SOUND,
        Bound("pivot_rate_error_max", 5e-3, "energy fixes the speed at every angle; a thousandth of the 5.4 rad/s at the end"),
        Bound("pivot_missing", 0.0, "it falls: from 0.1 rad it is down after 0.85 s"),
        Bound("energy_gain_max", 1e-9, "a floor without friction gives nothing"),
    ),
    regions=(Region(("rod",), (-1e-6, -1e-6, 0.0), (1e-6, 1e-6, INFINITE), "nothing pushes the rod sideways"),),
    expects={
        # followed until just before it lies
        "pivots": (Pivot("rod", lambda angle: rod_angular_velocity(START, max(angle, START), LENGTH, GRAVITY), 1.5),),
        "alone": (("rod",),),
    },
)
