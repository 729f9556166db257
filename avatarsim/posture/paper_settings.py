"""Constants of method `paper`, the paper's overlap removal as printed: each with its unit and what breaks if it changes."""

from typing import NamedTuple


class PaperSettings(NamedTuple):
    """How eqs. 1-6 and Algorithm 1 are repeated until nothing overlaps.

    stand_off        [m] added to every PD_g. 0 leaves bodies touching, and rounding decides whether they overlap.
    tolerance        [m] an end effector this close to its goal is there; must stay below `stand_off`, or the loop spins.
    sweeps           most sweeps of CCD per goal. Few: goals are missed, more rounds; many: time spent on goals out of reach.
    still            [rad] a sweep in which no joint turns more than this changes nothing any more.
    bend             [rad] a straight chain is bent by this before CCD is tried again; 0 leaves it straight, as printed.
    parallel         sine of the angle below which a link counts as parallel to the obstacle's surface; 0 switches the case off.
    rounds           most rounds over all chains per frame; what overlaps then is walked back.
    patience         rounds in which only limbs turn and trunks move; from then on a limb that is still caught shifts its whole
                     avatar, and simulated bodies give way. At least `rounds`: neither ever happens.
    walk_back        share of the frame's way to which the walk back is found. Coarser: a visible gap; finer: more queries.
    couple           1: roots follow the tracker by eq. 6; 0: at once.
    """

    stand_off: float = 1e-4
    tolerance: float = 2e-5
    sweeps: int = 24
    still: float = 1e-9
    bend: float = 0.1
    parallel: float = 0.17
    rounds: int = 16
    patience: int = 6
    walk_back: float = 1e-6
    couple: int = 1
