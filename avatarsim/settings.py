"""Every tolerance, cap and constant that a user may want to change, with its unit and the effect of a change."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from avatarsim.tolerances import JUDGED, NOTHING, POSTURE_GAP


class PostureSettings(NamedTuple):
    """Pursuit of the tracker by a posture (method `default`, docs/posture.md).

    stand_off       [m] gap aimed at; a quarter of it is accepted. 2e-5: more corrections and a longer slowest frame; 1e-3: air
                    one can see.
    catch_up_turn   [rad/s] how fast a joint may turn beyond the turn of the target. Larger: turns that look like jumps; smaller:
                    limbs that come free are late.
    catch_up_move   [m/s] likewise for a root. Larger: jumps; smaller: a body that was held off comes late.
    natural_frequency  [rad/s] of the critically damped spring between an avatar and its target. Motion without contact has no
                    lag. Larger: limbs dash off when they come free; smaller: they come back later.
    sticking_speed  [m/s] of a link's target at which friction on fixed bodies has fallen to a third. Larger: hands that are drawn
                    along a wall stay behind; smaller: feet that are set down gently skid.
    settle_time     [s] over which the target's speed is low-passed, in proportion to which the catch-up speeds fall once it holds
                    still. Larger: limbs that are pressed on things wander for longer; smaller: limbs far away come late.
    stall_time      [s] without progress after which a path is searched, or else the record reports a waiting avatar.
    near            [m] an avatar whose link origins are all nearer than this to the target does not wait.
    steps           steps per frame at most. 1: fast targets lag in contact; 3 only costs time.
    work            work that a frame may cost, in units of about a microsecond, counted and not timed, so that results repeat;
                    searches for paths take two thirds of it at most. When it is spent the last certified state is shown, with a
                    status in the record.
    around          0: no path is searched, an avatar waits at the obstacle. 1: only for avatars with joints, since a
                    hand without any that is pushed through a table is to lie on it. 2: for all.
    """

    stand_off: float = POSTURE_GAP
    catch_up_turn: float = 12.5
    catch_up_move: float = 5.0
    natural_frequency: float = 50.0
    sticking_speed: float = 0.2
    settle_time: float = 0.5
    stall_time: float = 0.1
    near: float = 0.05
    steps: int = 2
    work: int = 1200
    around: int = 1


class CouplingSettings(NamedTuple):
    """Eq. 6, the virtual coupling between tracker and driven body, with the paper's constants.

    spring   [N/m] the paper's K. Softer: a hand lags behind the tracker after a collision; stiffer: heavy objects feel like
             walls.
    damping  [N s/m] the paper's R. Less: a hand swings about its user after a collision; more: it creeps back.
    """

    spring: float = 1000.0
    damping: float = 40.0


class AttractionSettings(NamedTuple):
    """Coach and trainee (method `paper`).

    rate  [1/s] share of the way to the tracker's angles taken per second. 30: nine tenths of the way back in five frames of
          1/60 s. Higher is stiffer, lower trails behind the user.
    """

    rate: float = 30.0


class PaperSettings(NamedTuple):
    """Repetition of eqs. 1-6 and Algorithm 1 until nothing overlaps.

    stand_off        [m] added to every PD_g. 0 leaves bodies touching, and rounding decides whether they overlap.
    tolerance        [m] an end effector this close to its goal is there; must stay below `stand_off`, or the loop spins.
    sweeps           most sweeps of CCD per goal. Few: goals are missed, more rounds; many: time spent on goals out of reach.
    still            [rad] a sweep in which no joint turns more than this changes nothing any more.
    bend             [rad] a straight chain is bent by this before CCD is tried again; 0 leaves it straight, as printed.
    parallel         sine of the angle below which a link counts as parallel to the obstacle's surface; 0 switches the case off.
    rounds           most rounds over all chains per frame; limbs that overlap then are walked back.
    patience         rounds in which only limbs turn and trunks move; from then on a limb that is still caught shifts its whole
                     avatar, and simulated bodies give way. At least `rounds`: neither ever happens.
    walk_back        share of the frame's way to which the walk back is found. Coarser: a visible gap; finer: more queries.
    couple           1: roots follow the tracker by eq. 6; 0: at once.
    """

    stand_off: float = 1e-4
    tolerance: float = 2e-5
    sweeps: int = 24
    still: float = NOTHING
    bend: float = 0.1
    parallel: float = 0.17
    rounds: int = 16
    patience: int = 6
    walk_back: float = JUDGED
    couple: int = 1


class Chosen(NamedTuple):
    """All settings of one run together."""

    posture: PostureSettings = PostureSettings()
    paper: PaperSettings = PaperSettings()
    coupling: CouplingSettings = CouplingSettings()
    attraction: AttractionSettings = AttractionSettings()


def meanings(group: type) -> Mapping[str, str]:
    """Return the meaning of each setting of a group, with its unit where it has one: from the group's docstring, the one place
    where that is written. Empty where Python drops docstrings."""
    found: dict[str, str] = {}
    name = ""
    for line in (group.__doc__ or "").splitlines():
        entry = re.match(r"    ([a-z_]+) +(\S.*)", line)
        if entry and entry[1] in group.__annotations__:
            name = entry[1]
            found[name] = entry[2].strip()
        elif name and line.startswith("      ") and line.strip():
            found[name] += f" {line.strip()}"
        else:
            name = ""
    return found
