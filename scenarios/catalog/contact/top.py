"""A top spins fast on a smooth table: nothing takes its spin, and its axis goes round for ever.

The table pushes against the tip alone, and straight up, so the spin about the axis and the angular momentum about the vertical
stay; `reference.closed_form.top_precession` is the mean rate of the axis.
"""

import math

import numpy as np

from avatarsim.scene.body import solid
from avatarsim.scene.shape import ConvexHull, Piece
from reference.closed_form import top_precession
from scenarios.building.cases import LAID, laws, loose, slab, turned_by
from scenarios.building.expected import Top
from scenarios.building.promises import KEEPS_TIME, SOUND
from scenarios.building.scenes import undriven
from scenarios.scenario import Bound, Region

SIDES, RADIUS, RIM, MASS = 24, 0.03, (0.03, 0.04), 0.1
"""Sides and radius [m] of the top, a cone on its tip with a rim from one height to the other [m]; its mass [kg]."""
LEAN, SPIN = 0.2, 200.0
"""First lean of the axis [rad], and spin about it [rad/s]."""


def piece() -> Piece:
    """The top, its origin in its centre of mass."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    corners = np.vstack([np.zeros((1, 3)), *(np.insert(ring, 2, z, axis=1) for z in RIM)])
    return Piece(ConvexHull(corners - np.array(solid((Piece(ConvexHull(corners)),), MASS).centre)))


def reach() -> float:
    """Distance [m] from the tip to the centre of mass."""
    shape = piece().shape
    assert isinstance(shape, ConvexHull)
    return -float(shape.vertices[:, 2].min())


def precession() -> float:
    """How fast the axis goes round [rad/s]."""
    moments = np.diag(solid((piece(),), MASS).inertia)
    return top_precession(float(moments[0]), float(moments[2]), MASS, reach(), SPIN, LEAN, 9.81)


SCENARIO = undriven(
    "top", "A top spins on a smooth table.", "Its spin, and how fast its axis goes round; overlap.",
    lambda: (
        slab(2.0, 2.0, "table", "table"),
        loose("top", piece(), "top", MASS, (0.0, 0.0, reach() * math.cos(LEAN) + LAID), turned_by((0.0, 1.0, 0.0), LEAN),
              spin=(SPIN * math.sin(LEAN), 0.0, SPIN * math.cos(LEAN))),
    ),
    laws({("table", "top"): (0.0, 0.0)}), frames=300, short=120,
    bounds=(
        *SOUND, KEEPS_TIME,
        Bound("axis_spin_error_max", 1.0, "no torque acts about its axis; half a percent is not seen"),
        Bound("precession_error_max", 0.1, "by the closed form, give or take the part of a nod in which the time ends"),
        Bound("energy_gain_max", 1e-6, "nothing gives it energy"),
    ),
    regions=(Region(("top",), (-0.5, -0.5, 0.0), (0.5, 0.5, 0.1), "the top neither falls through the table nor flies away"),),
    expects={"tops": (Top("top", SPIN, precession()),), "alone": (("top",),)},
)
